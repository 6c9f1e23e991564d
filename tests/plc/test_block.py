"""The PLC's block, as its transcription runs: every point of the acceptance rule alone refuses a part."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.plc.block.definition import POINTS, REFUSALS
from station.plc.block.statements import body
from station.plc.block.transcribe import Block, _Writer, tokens
from station.plc.map.registers import (
    BY_NAME,
    COMMAND_START,
    COMMAND_WORDS,
    STATUS_START,
    STATUS_WORDS,
    TEST_F32,
    TEST_U32,
    Control,
    Flags,
    Status,
    Value,
    pack,
    pack_window,
    unpack_window,
)

GOOD: dict[str, Value] = {
    "STATUS": int(Status.ONLINE | Status.RESULT_VALID | Status.OK),
    "SEQ_HEAD": 5,
    "SEQ_TAIL": 5,
    "RESULT_TRIGGER_ID": 1,
    "ACK_TRIGGER_ID": 1,
    "VERDICT": 1,
    "VERDICT_INV": 0xFFFE,
    "ACTIVE_RECIPE": 1,
    "CONFIG_CRC": 77,
    "SERIAL_ECHO": "CELL-1",
    "RESULT_AGE_10MS": 3,
    "MAP_VERSION": 1,
}


def window(**changes: Value) -> list[int]:
    return pack_window(STATUS_START, STATUS_WORDS, {**GOOD, **changes})


class Plc:
    """A block, its clock and a station that answers as set."""

    def __init__(self, accept_simulated: bool = False, accept_novel: bool = False) -> None:
        self.block, self.now_s, self.beat = Block(), 0.0, 0
        v = self.v = self.block.v
        v.Serial, v.Crc, v.AcceptSimulated, v.AcceptNovel, v.WindowTime = (
            pack(BY_NAME["PART_SERIAL"], "CELL-1"),
            77,
            accept_simulated,
            accept_novel,
            4.0,
        )

    def cycle(self, words: list[int] | None = None, wait_s: float = 0.02, beats: bool = True) -> None:
        self.now_s += wait_s
        self.beat += beats
        self.v.Fresh = words is not None
        if words is not None:
            self.v.Window = [words[0], self.beat & 0xFFFF, *words[2:]]
        self.block.cycle(self.now_s)

    def until_in_work(self) -> "Plc":
        ready = window(STATUS=int(Status.READY), VERDICT=0, ACK_TRIGGER_ID=0)
        self.cycle(ready)
        self.v.Start = True
        self.cycle(ready)
        self.v.Start = False
        self.cycle(ready)
        assert self.v.Command[2:3] + self.v.Command[5:8] == [1, *pack(BY_NAME["PART_SERIAL"], "CELL-1")[:3]]
        assert self.v.Command[0] == Control.ENABLE, "the number is written before the trigger"
        self.cycle(ready)
        assert self.v.Command[0] == Control.ENABLE | Control.TRIGGER
        self.cycle(window(STATUS=int(Status.TRIGGER_ACK | Status.BUSY), VERDICT=0))
        assert self.v.Command[0] == Control.ENABLE
        return self


def refused(words: list[int], **options: bool) -> str | None:
    plc = Plc(**options).until_in_work()
    plc.cycle(words)
    assert plc.v.State == 50
    assert not plc.v.PartOk, "only with PartDone"
    plc.cycle(window(STATUS=int(Status.ONLINE), VERDICT=0))
    assert plc.v.PartDone
    assert plc.v.PartOk == (plc.v.Refusal == 0)
    return REFUSALS[plc.v.Refusal] or None


def test_a_part_from_start_to_done() -> None:
    plc = Plc().until_in_work()
    plc.cycle(window())
    assert not plc.v.PartOk
    assert not plc.v.PartDone
    assert plc.v.Command[0] == Control.ENABLE | Control.RESULT_ACK
    plc.cycle(window(STATUS=int(Status.ONLINE), VERDICT=0))
    assert (plc.v.PartOk, plc.v.PartDone, plc.v.Busy, plc.v.Command[0]) == (True, True, False, Control.ENABLE)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"STATUS": int(Status.RESULT_VALID)}, "OK and NOK"),
        ({"STATUS": int(Status.RESULT_VALID | Status.OK | Status.NOK)}, "OK and NOK"),
        ({"VERDICT": 4, "VERDICT_INV": 0xFFFB}, "VERDICT"),
        ({"VERDICT_INV": 0}, "complement"),
        ({"SEQ_TAIL": 4}, "SEQ_HEAD"),
        ({"RESULT_TRIGGER_ID": 8}, "another trigger"),
        ({"SERIAL_ECHO": "CELL-2"}, "another serial"),
        ({"ACTIVE_RECIPE": 2}, "recipe"),
        ({"CONFIG_CRC": 78}, "configuration"),
        ({"RESULT_AGE_10MS": 501}, "too old"),
        ({"STATUS": GOOD["STATUS"] | Status.FAILURE}, "failure"),  # type: ignore[operator]
        ({"STATUS": GOOD["STATUS"] | Status.FUNCTION_CHECK}, "function check"),  # type: ignore[operator]
        ({"FLAGS": int(Flags.SIMULATED)}, "emulated camera"),
        ({"FLAGS": int(Flags.NOVEL)}, "unlike the training images"),
    ],
)
def test_each_point_alone_refuses(changes: dict[str, Value], said: str) -> None:
    reason = refused(window(**changes))
    assert reason is not None
    assert said in reason


def test_a_standing_heartbeat_refuses() -> None:
    plc = Plc().until_in_work()
    for _ in range(30):
        plc.cycle(beats=False)
    plc.cycle(window(), beats=False)
    assert REFUSALS[plc.v.Refusal] == "heartbeat stands still"


def test_the_first_read_alone_proves_no_heartbeat() -> None:
    plc = Plc()
    plc.cycle(window())
    assert not plc.v.BeatFresh
    plc.cycle(window())
    assert plc.v.BeatFresh


def test_simulated_pictures_pass_only_where_wanted() -> None:
    assert refused(window(FLAGS=int(Flags.SIMULATED)), accept_simulated=True) is None


def test_a_part_unlike_the_training_images_passes_only_where_wanted() -> None:
    flags = int(Flags.NOVEL)
    assert refused(window(FLAGS=flags), accept_novel=True) is None
    both = int(Flags.NOVEL | Flags.SIMULATED)
    for simulated, novel in ((False, True), (True, False)):
        assert refused(window(FLAGS=both), accept_simulated=simulated, accept_novel=novel) is not None


def test_a_master_never_passes_and_asks_for_the_check() -> None:
    plc = Plc()
    plc.v.Golden = True
    ready = window(STATUS=int(Status.READY), VERDICT=0, ACK_TRIGGER_ID=0)
    plc.cycle(ready)
    plc.v.Start = True
    for _ in range(3):
        plc.cycle(ready)
    assert plc.v.Command[0] == Control.ENABLE | Control.TRIGGER | Control.GOLDEN_CHECK
    plc.cycle(window(STATUS=int(Status.TRIGGER_ACK), VERDICT=0))
    plc.cycle(window())
    plc.cycle(window(STATUS=0, VERDICT=0))
    assert plc.v.PartDone
    assert not plc.v.PartOk


@pytest.mark.parametrize(
    ("answers", "said"), [(0, "station not READY, or without heartbeat"), (3, "no result inside the window")]
)
def test_a_window_that_passes_refuses_and_frees_the_block(answers: int, said: str) -> None:
    plc = Plc()
    plc.cycle(window())
    plc.v.Start = True
    for number in range(120):
        bits = Status.READY if number < answers else Status(0)
        plc.cycle(window(STATUS=int(bits), VERDICT=0, ACK_TRIGGER_ID=0), wait_s=0.05)
        if plc.v.PartDone:
            break
    assert (plc.v.PartDone, plc.v.PartOk, plc.v.State, plc.v.Busy) == (True, False, 0, False)
    assert REFUSALS[plc.v.Refusal] == said
    assert plc.v.Command[0] == Control.ENABLE


def test_an_ok_of_the_part_before_is_gone_with_the_next_start() -> None:
    plc = Plc().until_in_work()
    plc.cycle(window())
    plc.cycle(window(STATUS=0, VERDICT=0))
    assert plc.v.PartOk
    assert plc.v.Result.VERDICT == 1
    plc.v.Start = True
    plc.cycle(window(STATUS=0, VERDICT=0))
    assert not plc.v.PartOk
    assert not plc.v.PartDone
    assert (plc.v.Busy, plc.v.Result.VERDICT, plc.v.Result.NUMBER) == (True, 0, 1)


def test_the_number_of_the_last_trigger_is_never_used_again() -> None:
    plc = Plc()
    plc.cycle(window(STATUS=int(Status.READY), ACK_TRIGGER_ID=1))
    plc.v.Start = True
    for _ in range(3):
        plc.cycle(window(STATUS=int(Status.READY), ACK_TRIGGER_ID=1))
    assert plc.v.Command[2] == 2


@given(st.integers(1, STATUS_WORDS - 1))
def test_a_read_torn_between_a_wiped_and_a_good_record_never_passes(cut: int) -> None:
    good = window()
    wiped = pack_window(
        STATUS_START, STATUS_WORDS, {"SEQ_HEAD": 4, "SEQ_TAIL": 4, "CONFIG_CRC": 77, "ACTIVE_RECIPE": 1}
    )
    for torn in (good[:cut] + wiped[cut:], wiped[:cut] + good[cut:]):
        plc = Plc().until_in_work()
        plc.cycle(torn)
        plc.cycle(window(STATUS=0, VERDICT=0))
        same = [*torn[:1], *torn[2:]] == [*good[:1], *good[2:]]
        read = unpack_window(STATUS_START, torn)
        of_no_use = all(
            read[name] == GOOD.get(name, 0)
            for name in read
            if name not in ("HEARTBEAT", "MAP_VERSION", "ACK_TRIGGER_ID")
        )
        assert same or of_no_use or not plc.v.PartOk, cut


@given(st.lists(st.integers(0, 0xFFFF), min_size=STATUS_WORDS, max_size=STATUS_WORDS))
def test_noise_never_passes(words: list[int]) -> None:
    plc = Plc().until_in_work()
    plc.cycle(words)
    assert not plc.v.PartOk
    plc.cycle(window(STATUS=0, VERDICT=0))
    assert not plc.v.PartOk


def test_the_record_is_decoded() -> None:
    plc = Plc()
    plc.cycle(window(INSPECTION_ID=70000, SEG_SCORE=tuple(range(21)), TEST_U32=TEST_U32, TEST_F32=TEST_F32))
    info = plc.v.Info
    assert (info.INSPECTION_ID, info.TEST_U32, info.SEG_SCORE) == (70000, 0x12345678, list(range(21)))
    assert info.TEST_F32 == pytest.approx(123.456, abs=1e-5)


def test_the_block_writes_inside_the_command_window() -> None:
    assert len(Block().v.Command) == COMMAND_WORDS
    assert COMMAND_START == 0


def test_what_is_not_structured_text_is_refused() -> None:
    with pytest.raises(ValueError, match="not Structured Text"):
        tokens("a := b ? c;")
    assert len(POINTS) == body().count("IF (Refusal = 0)")
    with pytest.raises(ValueError, match="instead of"):
        _Writer("a := b").program()
