"""The block in controllers that differ: timers, edges, a program that lets Start not rest, missing flags."""

import random
import re
import struct
from collections import Counter
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from deploy.chaos.judge import judged
from station.plc.block.data_types import COPIED
from station.plc.block.definition import NO_RESULT, POINTS, REFUSALS, START_AGAIN, VARIABLES
from station.plc.block.dialects import scl, structured_text
from station.plc.block.statements import body
from station.plc.block.timers import TimerKind
from station.plc.block.transcribe import Block
from station.plc.handshake import step
from station.plc.handshake_state import Inputs, State, Times
from station.plc.map import status_window
from station.plc.map.registers import (
    BY_NAME,
    STATUS_START,
    Control,
    Flags,
    Offline,
    Status,
    VerdictCode,
    pack,
    pack_window,
)
from station.plc.port import Counts, Health
from tests.plc.test_block import Plc, window

LOOPS = ((0, 15), (0, 20), (1, 40))
"""Bounds of loops: constants, and more than one turn, as one compiler leaves out a loop of one."""
AT = {name: register.address - STATUS_START for name, register in BY_NAME.items()}
READY = window(STATUS=int(Status.READY), VERDICT=0, ACK_TRIGGER_ID=0)
WIPED = window(STATUS=int(Status.ONLINE | Status.READY), VERDICT=0)


class Station:
    """Windows of a station that judges at random, seen through reads that may be old."""

    def __init__(self, rng: random.Random) -> None:
        self.rng, self.words, self.beat = rng, [0] * len(READY), 0
        self.truth: dict[int, tuple[bool, list[int]]] = {}
        """Whether a trigger's part was judged OK, and its serial, by trigger number."""
        self.before = 0

    def cycle(self, now_s: float, command: list[int]) -> None:
        """Take in the command window, as the station's handshake does."""
        status, rising = self.words[0], command[0] & ~self.before
        self.before = command[0]
        if status & Status.RESULT_VALID and rising & (Control.RESULT_ACK | Control.TRIGGER):
            last = {"ACK_TRIGGER_ID": self.words[AT["ACK_TRIGGER_ID"]]}
            self.words, status = pack_window(STATUS_START, len(READY), last), int(Status.READY)
        if rising & Control.TRIGGER and command[2] not in (0, self.words[AT["ACK_TRIGGER_ID"]]):
            self.words[AT["ACK_TRIGGER_ID"]] = command[2]
            self.truth[command[2]] = self.rng.random() < 0.7, command[5:21]
            status = int(Status.BUSY | Status.TRIGGER_ACK)
        elif status & Status.BUSY and self.rng.random() < 0.3:
            status = self._show(status & Status.TRIGGER_ACK)
        elif not status & (Status.BUSY | Status.RESULT_VALID):
            status = int(Status.ONLINE) | (int(Status.READY) if self.rng.random() < 0.9 else 0)
        if not command[0] & Control.TRIGGER:
            status &= ~int(Status.TRIGGER_ACK)
        self.words[0], self.words[1] = status, int(now_s * 10) & 0xFFFF
        self.words[AT["ACTIVE_RECIPE"]], self.words[AT["CONFIG_CRC"]] = 1, 77

    def _show(self, kept: int) -> int:
        good, serial = self.truth[self.words[AT["ACK_TRIGGER_ID"]]]
        self.words[AT["RESULT_TRIGGER_ID"]] = self.words[AT["ACK_TRIGGER_ID"]]
        self.words[AT["VERDICT"]], self.words[AT["VERDICT_INV"]] = (1, 0xFFFE) if good else (2, 0xFFFD)
        self.words[AT["SERIAL_ECHO"] : AT["SERIAL_ECHO"] + 16] = serial
        shown = (
            Status.READY | Status.RESULT_VALID | Status.EXPOSURE_DONE | (Status.OK if good else Status.NOK)
        )
        return int(shown) | kept


def test_after_a_refused_trigger_the_next_part_waits_until_the_station_has_seen_it_drop() -> None:
    """The station reads each seventh cycle, as in client mode: a short low of TRIGGER would be no edge."""
    block, state, window, now_s, answered = Block(), State(), [0] * len(READY), 100.0, []
    v, health = block.v, Health(ready=True, offline=Offline.NONE, failure=False, config_crc=77)
    v.Crc, v.WindowTime = 77, 1.0
    for cycle in range(1500):
        now_s += 0.004
        v.Window, v.Fresh = list(window), True
        v.Start = v.Ready or (v.Busy and v.Start)
        block.cycle(now_s)
        if v.PartDone:
            answered.append(v.Result.REFUSAL)
        if cycle % 7:
            continue
        wrong_id = len(answered) in (0, 1, 4)
        inputs = Inputs(
            control=Control(v.Command[0]),
            plc_heartbeat=v.Command[1],
            trigger_id=0 if wrong_id else v.Command[2],
            serial="",
            serial_words=tuple(v.Command[5:21]),
            command=0,
            health=health,
            health_age_s=0.0,
            result=None if state.trigger is None else judged(state.trigger, VerdictCode.OK),
        )
        outcome = step(state, inputs, now_s, Times())
        state = outcome.state
        words = status_window.values(state, health, now_s, Counts())
        window = pack_window(STATUS_START, len(READY), words)
    assert answered[:4] == [NO_RESULT, NO_RESULT, 0, 0]
    assert answered[4] == NO_RESULT
    assert len(answered) > 8
    assert set(answered[5:]) == {0}


def outputs(block: Block) -> dict[str, object]:
    """All outputs, without PLC_HEARTBEAT."""
    found = {each.name: getattr(block.v, each.name) for each in VARIABLES if each.role == "output"}
    found["Command"] = [*found["Command"][:1], *found["Command"][2:]]
    return {name: vars(kept) if isinstance(kept, SimpleNamespace) else kept for name, kept in found.items()}


def test_both_kinds_of_timers_agree_over_a_hundred_thousand_random_cycles() -> None:
    """Cycle times are multiples of 0.7 ms, so that no time-out falls between two accesses of one cycle."""
    rng = random.Random(30)
    blocks, station = [Block(kind) for kind in TimerKind], Station(rng)
    steps, beats, refusals = 0, [Counter(), Counter()], Counter()
    for number in range(100_000):
        steps += rng.choice((1, 3, 14, 14, 14, 28, 200)) if number % 5000 else 9000
        now_s = steps * 0.0007
        station.cycle(now_s, blocks[0].v.Command)
        read = rng.random() < 0.8
        noise = [rng.randrange(0x10000) for _ in READY] if rng.random() < 0.002 else None
        start, serial, golden = rng.random() < 0.5, [rng.randrange(2)] * 16, rng.random() < 0.01
        again = rng.random() < 0.04
        for block in blocks:
            v = block.v
            v.Fresh, v.Crc = read, 77
            if read:
                v.Window = noise or list(station.words)
            if v.Busy:
                v.Start = v.Start != again
            else:
                v.Start, v.Serial, v.Golden = start, serial, golden
            block.cycle(now_s)
        first, second = (outputs(block) for block in blocks)
        assert first == second, number
        for count, block in zip(beats, blocks, strict=True):
            count[block.v.Command[1]] += 1
        refusals[blocks[0].v.Refusal if blocks[0].v.PartDone else -1] += 1
    assert len(beats[0]) == pytest.approx(len(beats[1]), rel=0.01)
    assert refusals[0] > 500, "parts passed"
    assert refusals[3] > 100, "parts were NOK"
    assert refusals[START_AGAIN] > 100


@pytest.mark.parametrize("kind", TimerKind)
@pytest.mark.parametrize("scan_ms", [1, 10, 50])
def test_the_heartbeat_of_the_plc_moves_in_every_controller(kind: TimerKind, scan_ms: int) -> None:
    block, now_s, changed_s, before = Block(kind), 0.0, 0.0, 0
    for _ in range(30_000 // scan_ms):
        now_s += scan_ms / 1000
        block.cycle(now_s)
        if block.v.Command[1] != before:
            before, changed_s = block.v.Command[1], now_s
        assert now_s - changed_s < 0.1 + 3 * scan_ms / 1000
    assert before >= 30 / (0.1 + 3 * scan_ms / 1000)


def test_a_part_without_rest_of_start_never_gets_the_answer_of_the_part_before() -> None:
    """A program that drops Start at PartDone and raises it before the next call shows the block no edge."""
    plc = Plc().until_in_work()
    plc.v.Start = True
    plc.v.StartBefore = True  # it was held all the time
    plc.cycle(window())
    plc.cycle(WIPED)
    assert (plc.v.PartDone, plc.v.PartOk) == (True, True)
    for _ in range(20):
        plc.cycle(WIPED)
        assert not plc.v.PartDone
        assert not plc.v.PartOk
        assert not plc.v.Ready, "the next part may not begin"
        assert plc.v.Result.NUMBER == 1
    plc.v.Start = False
    plc.cycle(WIPED)
    assert plc.v.Ready


@pytest.mark.parametrize("state", [10, 20, 30, 40, 50])
def test_a_start_while_a_part_is_in_work_is_refused_by_name(state: int) -> None:
    plc = Plc()
    plc.cycle(READY)
    answers = {10: READY, 20: READY, 30: window(STATUS=int(Status.TRIGGER_ACK), VERDICT=0), 40: window()}
    plc.v.Start, done = True, False
    for _ in range(4):
        plc.cycle(window(STATUS=0, VERDICT=0, ACK_TRIGGER_ID=0))
        plc.v.Start = not plc.v.StartBefore and state == 10
    plc.v.Start = False
    for _ in range(10):
        plc.cycle(None)
        plc.v.Start = plc.v.State == state and not plc.v.StartBefore
        plc.cycle(answers.get(plc.v.State, WIPED))
        done = done or plc.v.PartDone
        if plc.v.PartDone:
            break
    assert done
    assert not plc.v.PartOk
    assert REFUSALS[plc.v.Refusal] == "Start rose again while the part was in work"
    assert plc.v.Result.REFUSAL == START_AGAIN


def test_a_start_that_is_held_as_the_plc_starts_is_no_edge() -> None:
    plc = Plc()
    plc.v.Start = True
    for _ in range(3):
        plc.cycle(READY)
    assert not plc.v.Busy


@pytest.mark.parametrize("verdict", [VerdictCode.OK, VerdictCode.NOK, VerdictCode.ERROR, VerdictCode.TEST])
def test_the_result_outlives_the_record_that_the_station_wipes(verdict: VerdictCode) -> None:
    bit = {VerdictCode.OK: Status.OK, VerdictCode.NOK: Status.NOK}.get(verdict, Status(0))
    shown = {
        "STATUS": int(Status.RESULT_VALID | bit),
        "VERDICT": int(verdict),
        "VERDICT_INV": 0xFFFF ^ verdict,
        "REASON": 5,
        "ERROR_CODE": 0x1005,
        "INSPECTION_ID": 70001,
        "FLAGS": int(Flags.DRIFT),
        "SEG_NOK_MASK": 9,
        "SEG_INVALID_MASK": 6,
        "WORST_SEG": 3,
        "WORST_SCORE": 9000,
        "SEG_SCORE": tuple(range(21)),
    }
    plc = Plc().until_in_work()
    plc.cycle(window(**shown))
    plc.cycle(WIPED)
    assert plc.v.PartDone
    kept = vars(plc.v.Result)
    expected = {name: list(shown[name]) if name == "SEG_SCORE" else shown[name] for name in COPIED}  # type: ignore[arg-type, call-overload]
    assert {name: kept[name] for name in COPIED} == expected
    assert (kept["NUMBER"], kept["TRIGGER_ID"], kept["REFUSAL"]) == (1, 1, plc.v.Refusal)


def test_exposure_done_is_that_of_the_part_in_work() -> None:
    plc = Plc().until_in_work()
    plc.cycle(window(STATUS=int(Status.EXPOSURE_DONE), ACK_TRIGGER_ID=9, VERDICT=0))
    assert not plc.v.ExposureDone
    plc.cycle(window(STATUS=int(Status.EXPOSURE_DONE), VERDICT=0))
    assert plc.v.ExposureDone
    plc.cycle(window())
    plc.cycle(WIPED)
    assert (plc.v.PartDone, plc.v.ExposureDone) == (True, False)


def test_an_error_of_the_part_before_is_cleared_with_the_next_trigger_alone() -> None:
    plc = Plc()
    failed = window(STATUS=int(Status.READY | Status.ERROR), VERDICT=0, ACK_TRIGGER_ID=0)
    plc.cycle(failed)
    assert not plc.v.Command[0] & Control.CLEAR_ERROR
    plc.v.Start = True
    for _ in range(3):
        plc.cycle(failed)
    assert plc.v.Command[0] == Control.ENABLE | Control.TRIGGER | Control.CLEAR_ERROR


@pytest.mark.parametrize(("reads_ms", "fresh"), [(100, True), (300, True), (900, False)])
def test_the_time_for_the_heartbeat_is_an_input(reads_ms: int, fresh: bool) -> None:
    for time_s, expected in ((0.5, fresh), (3.0, True), (0.0, False)):
        plc = Plc()
        plc.v.HeartbeatTime = time_s
        for _ in range(5):
            plc.cycle(READY)
            for _ in range(reads_ms // 20):
                plc.cycle(None)
        assert plc.v.BeatFresh is expected, time_s


def test_the_time_of_the_plc_is_written() -> None:
    plc = Plc()
    plc.v.PlcTime = 1_800_000_001
    plc.cycle(READY)
    assert plc.v.Command[21:23] == pack(BY_NAME["PLC_TIME"], 1_800_000_001)


def test_a_reader_without_a_flag_for_new_reads_never_passes_another_part() -> None:
    """Fresh is always TRUE, the window is up to 20 cycles old: a part passes on its own result alone."""
    rng, now_s, passed = random.Random(10), 0.0, 0
    block, station = Block(), Station(random.Random(11))
    v = block.v
    v.Crc, v.Fresh, v.Window = 77, True, [0] * len(READY)
    for _ in range(20_000):
        now_s += 0.01
        station.cycle(now_s, v.Command)
        if rng.random() < 0.1:
            v.Window = list(station.words)
        v.Start = v.Ready and rng.random() < 0.5
        if v.Ready:
            v.Serial = [rng.randrange(0x10000) for _ in range(16)]
        block.cycle(now_s)
        if v.PartOk:
            assert station.truth[v.TriggerId] == (True, v.Serial)
            passed += 1
    assert passed > 50


@given(st.integers(0, 0xFFFFFFFF))
def test_a_real_is_decoded_by_arithmetic_everywhere(bits: int) -> None:
    plc = Plc()
    words = window()
    words[AT["TEST_F32"] : AT["TEST_F32"] + 2] = [bits >> 16, bits & 0xFFFF]
    plc.cycle(words)
    expected = struct.unpack(">f", struct.pack(">I", bits))[0]
    near = 110 < (bits >> 23) % 256 < 190
    assert plc.v.Info.TEST_F32 == (expected if near else 0.0)


def test_the_statements_use_only_what_all_controllers_do_alike() -> None:
    text = re.sub(r"\(\*.*?\*\)", "", body())
    assert "NOT (" not in text, "a negated comparison: use a BOOL between"
    assert not re.search(r"\b(R_TRIG|F_TRIG|TOF|TP)\b", structured_text())
    timers = [each.name for each in VARIABLES if each.type == "TON"]
    for timer in timers:
        reads = re.findall(rf"(.*)\b{timer}\.(\w+)", text)
        assert [member for _, member in reads] == ["Q"], f"{timer}: read once"
        assert re.search(rf"{timer}\(IN := [^;]*\);\n\w+ := {timer}\.Q;", text), (
            f"{timer}: right after its call"
        )
    assert not set(re.findall(r"FOR i := (.+?) DO", text)) - {f"{low} TO {high}" for low, high in LOOPS}
    assert text.count("Holds := ") == len(POINTS) + 1


def test_every_parameter_has_a_type_with_a_name() -> None:
    sections = re.findall(r"VAR(?:_INPUT|_OUTPUT)?\n(.*?)END_VAR", structured_text(), re.S)
    assert len(sections) == 3
    assert not any("ARRAY" in section for section in sections)
    assert "Window : Array[0..75] of Word" in scl().replace("WORD", "Word")
