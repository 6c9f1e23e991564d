"""The handshake as a law: for all inputs and times, OK is only shown for a judged frame of that trigger."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from deploy.chaos.judge import judged
from station.plc.handshake import ready, step
from station.plc.handshake_state import Inputs, State, Step, Times
from station.plc.map import status_window
from station.plc.map.registers import (
    BY_NAME,
    MAP,
    REFUSED,
    STATUS_START,
    STATUS_WORDS,
    CommandCode,
    Control,
    Offline,
    Status,
    VerdictCode,
    number,
    pack_window,
    unpack,
)
from station.plc.port import NO_SERIAL, Command, Counts, Health, Result, Trigger

WELL = Health(ready=True, offline=Offline.NONE, failure=False, config_crc=7)
LOST = Health(ready=False, offline=Offline.CAMERA_LOST, failure=True, config_crc=7)
TIMES = Times()
ON = Control.ENABLE


def result(trigger: Trigger, verdict: VerdictCode = VerdictCode.OK) -> Result:
    return replace(judged(trigger, verdict, 9), error_code=0x1001 if verdict is VerdictCode.ERROR else 0)


def inputs(control: Control, trigger_id: int, health_age_s: float, beat: int = 999) -> Inputs:
    return Inputs(
        control=control,
        plc_heartbeat=beat,
        trigger_id=trigger_id,
        serial="S",
        command=0,
        health=WELL,
        health_age_s=health_age_s,
    )


class Driver:
    """A PLC and a clock."""

    def __init__(self) -> None:
        self.state, self.now, self.beat = State(), 100.0, 0
        self.control, self.trigger_id, self.health, self.silent, self.command = Control(0), 0, WELL, False, 0
        self.serial_words, self.plc_time_s = NO_SERIAL, 0
        self.started: list[Trigger] = []
        self.commanded: list[Command] = []

    def step(
        self,
        offered: Result | None = None,
        wait_s: float = 0.01,
        exposed: int | None = None,
        done: tuple[int, bool] | None = None,
        link: bool = True,
        link_was_lost: bool = False,
    ) -> Step:
        self.now += wait_s
        self.beat += not self.silent
        inputs = Inputs(
            control=self.control,
            plc_heartbeat=self.beat & 0xFFFF,
            trigger_id=self.trigger_id,
            serial="S",
            command=self.command,
            health=self.health,
            health_age_s=0.0,
            exposure_done_for=exposed,
            result=offered,
            arg=2,
            serial_words=self.serial_words,
            plc_time_s=self.plc_time_s,
            command_done=done,
            link=link,
            link_was_lost=link_was_lost,
        )
        outcome = step(self.state, inputs, self.now, TIMES)
        self.state = outcome.state
        if outcome.start is not None:
            self.started.append(outcome.start)
        if outcome.command is not None:
            self.commanded.append(outcome.command)
        if outcome.again:
            self.step(wait_s=0)
        return outcome

    def values(self) -> dict[str, object]:
        return dict(status_window.values(self.state, self.health, self.now, Counts()))

    def bits(self) -> Status:
        return Status(number(status_window.values(self.state, self.health, self.now, Counts()), "STATUS"))

    def trigger(self, trigger_id: int) -> None:
        self.control = ON
        self.step()
        self.control, self.trigger_id = ON | Control.TRIGGER, trigger_id
        self.step()


@pytest.fixture
def plc() -> Driver:
    driver = Driver()
    driver.control = ON
    driver.step()
    return driver


def test_a_part_from_trigger_to_acknowledge(plc: Driver) -> None:
    assert Status.READY in plc.bits()
    plc.trigger(1)
    assert (
        plc.bits() & (Status.TRIGGER_ACK | Status.BUSY | Status.RESULT_VALID)
        == Status.TRIGGER_ACK | Status.BUSY
    )
    assert [t.trigger_id for t in plc.started] == [1]
    plc.step(exposed=plc.started[-1].number)
    assert Status.EXPOSURE_DONE in plc.bits()
    plc.control = ON
    plc.step()
    assert Status.TRIGGER_ACK not in plc.bits()
    assert not plc.step(result(plc.started[-1])).refused
    assert plc.bits() & (Status.RESULT_VALID | Status.OK | Status.NOK) == Status.RESULT_VALID | Status.OK
    plc.control = ON | Control.RESULT_ACK
    plc.step()
    assert plc.values()["VERDICT"] == 0
    assert Status.READY not in plc.bits()
    plc.control = ON
    plc.step()
    assert Status.READY in plc.bits()


def test_every_register_of_the_status_window_has_a_value_while_a_result_is_shown(plc: Driver) -> None:
    """A register without one would read 0 forever."""
    plc.trigger(1)
    plc.step(result(plc.started[-1]))
    assert set(plc.values()) == {register.name for register in MAP if register.address >= STATUS_START}


def test_the_old_result_is_gone_before_trigger_ack(plc: Driver) -> None:
    plc.trigger(1)
    plc.step(result(plc.started[-1]))
    plc.control = ON
    plc.step()
    plc.control, plc.trigger_id = ON | Control.TRIGGER, 2
    plc.now += 0.01
    wiped = step(plc.state, inputs(plc.control, 2, 0.0, beat=500), plc.now, TIMES)
    assert wiped.again
    assert wiped.start is None
    shown = status_window.values(wiped.state, WELL, plc.now, Counts())
    assert shown["VERDICT"] == 0
    assert Status.TRIGGER_ACK not in Status(number(shown, "STATUS"))


@pytest.mark.parametrize("trigger_id", [0, 1])
def test_zero_and_repeated_ids_are_missed(trigger_id: int, plc: Driver) -> None:
    plc.trigger(1)
    plc.step(result(plc.started[-1]))
    plc.trigger(trigger_id)
    assert [t.trigger_id for t in plc.started] == [1]
    assert Status.MISSED_TRIGGER in plc.bits()
    assert plc.values()["ERROR_CODE"] == 0x2103


def test_a_trigger_while_busy_is_missed(plc: Driver) -> None:
    plc.trigger(1)
    plc.trigger(2)
    assert [t.trigger_id for t in plc.started] == [1]
    assert Status.MISSED_TRIGGER in plc.bits()


def test_a_late_result_is_error_and_stays_error(plc: Driver) -> None:
    plc.trigger(1)
    plc.step(wait_s=TIMES.deadline_s + 0.1)
    assert plc.values()["VERDICT"] == VerdictCode.ERROR
    assert plc.step(result(plc.started[-1])).refused
    assert plc.values()["VERDICT"] == VerdictCode.ERROR


def test_abort_gives_error(plc: Driver) -> None:
    plc.trigger(1)
    plc.control |= Control.ABORT
    plc.step()
    assert plc.values()["VERDICT"] == VerdictCode.ERROR
    assert plc.values()["ERROR_CODE"] == 0x2102


def test_an_unread_result_is_wiped_after_its_time(plc: Driver) -> None:
    plc.trigger(1)
    plc.step(result(plc.started[-1]))
    plc.control = ON
    plc.step(wait_s=TIMES.result_ttl_s + 0.1)
    assert plc.values()["VERDICT"] == 0


@pytest.mark.parametrize("how", ["disable", "offline", "silent"])
def test_leaving_the_line_wipes_the_result(how: str, plc: Driver) -> None:
    plc.trigger(1)
    plc.step(result(plc.started[-1]))
    plc.control = {"disable": Control(0), "offline": ON | Control.SET_OFFLINE, "silent": ON}[how]
    plc.silent = how == "silent"
    plc.step(wait_s=TIMES.plc_heartbeat_s + 0.1)
    plc.step()
    assert plc.values()["VERDICT"] == 0
    assert Status.READY not in plc.bits()
    assert plc.values()["OFFLINE_REASON"] == {"disable": 2, "offline": 3, "silent": 6}[how]


def test_a_result_for_a_part_that_was_dropped_is_never_shown(plc: Driver) -> None:
    plc.trigger(1)
    plc.control = Control(0)
    plc.step()
    plc.control = ON
    plc.step()
    assert plc.step(result(plc.started[-1])).refused
    assert plc.values()["VERDICT"] == 0


def test_a_late_result_never_answers_a_newer_part_of_the_same_id(plc: Driver) -> None:
    plc.trigger(1)
    late = plc.started[-1]
    for trigger_id in (2, 1):
        plc.control |= Control.ABORT
        plc.step()
        plc.trigger(trigger_id)
    assert plc.started[-1].trigger_id == late.trigger_id
    assert plc.step(result(late)).refused
    assert plc.values()["VERDICT"] == 0


def test_a_bit_held_over_a_restart_is_no_edge() -> None:
    driver = Driver()
    driver.control, driver.trigger_id = ON | Control.TRIGGER, 5
    for _ in range(3):
        driver.step()
    assert driver.started == []


def test_a_trigger_in_the_step_of_the_result_does_not_swallow_it(plc: Driver) -> None:
    plc.trigger(1)
    plc.control = ON
    plc.step()
    plc.control, plc.trigger_id = ON | Control.TRIGGER, 2
    plc.step(result(plc.started[-1]))
    assert Status.RESULT_VALID in plc.bits()
    assert Status.MISSED_TRIGGER in plc.bits()


def test_a_golden_check_starts_a_part_that_says_so(plc: Driver) -> None:
    plc.control, plc.trigger_id = ON | Control.TRIGGER | Control.GOLDEN_CHECK, 3
    plc.step()
    assert [t.golden for t in plc.started] == [True]
    plc.step(result(plc.started[-1], VerdictCode.TEST))
    assert plc.bits() & (Status.OK | Status.NOK | Status.FUNCTION_CHECK) == Status.FUNCTION_CHECK


@pytest.mark.parametrize(("well", "echo"), [(True, 2), (False, REFUSED)])
def test_a_recipe_is_loaded_with_ready_at_zero_and_the_result_wiped(
    well: bool, echo: int, plc: Driver
) -> None:
    plc.trigger(1)
    plc.step(result(plc.started[-1]))
    plc.control, plc.command = ON | Control.EXEC_COMMAND, CommandCode.LOAD_RECIPE
    plc.step()
    assert (plc.commanded, plc.values()["CMD_ECHO"], plc.values()["VERDICT"]) == ([], REFUSED, 1), (
        "an unread result is not wiped"
    )
    for control in (ON | Control.RESULT_ACK, ON, ON | Control.EXEC_COMMAND):
        plc.control = control
        plc.step()
    (command,) = plc.commanded
    assert (plc.values()["VERDICT"], plc.values()["OFFLINE_REASON"]) == (0, Offline.PREPARING)
    assert not plc.bits() & (Status.READY | Status.CMD_DONE)
    plc.step(done=(command.number, well))
    assert plc.values()["CMD_ECHO"] == echo
    assert plc.bits() & (Status.READY | Status.CMD_DONE) == Status.READY | Status.CMD_DONE
    plc.control = ON
    plc.step()
    assert Status.CMD_DONE not in plc.bits()


@pytest.mark.parametrize("code", [CommandCode.RESET_COUNTERS, CommandCode.TIME_SYNC])
def test_a_command_of_the_line_leaves_an_unread_result_alone(code: CommandCode, plc: Driver) -> None:
    plc.trigger(1)
    plc.step(result(plc.started[-1]))
    plc.control, plc.command, plc.plc_time_s = ON | Control.EXEC_COMMAND, code, 1_800_000_000
    plc.step()
    assert [c.code for c in plc.commanded] == [code]
    assert (plc.values()["CMD_ECHO"], plc.values()["VERDICT"]) == (code, 1)


def test_a_comparison_of_clocks_without_a_time_of_the_plc_is_refused(plc: Driver) -> None:
    plc.control, plc.command = ON | Control.EXEC_COMMAND, CommandCode.TIME_SYNC
    plc.step()
    assert not plc.commanded
    assert plc.values()["CMD_ECHO"] == REFUSED


@given(st.lists(st.integers(0, 0xFFFF), min_size=16, max_size=16))
def test_the_serial_comes_back_word_by_word_whatever_text_it_holds(words: list[int]) -> None:
    """Bytes above 127, bytes behind a NUL, the length bytes of a STRING: the PLC compares words."""
    plc = Driver()
    plc.control, plc.serial_words = ON, tuple(words)
    plc.step()
    plc.step()
    plc.trigger(1)
    plc.step(result(plc.started[-1]))
    window = pack_window(STATUS_START, STATUS_WORDS, status_window.values(plc.state, WELL, plc.now, Counts()))
    register = BY_NAME["SERIAL_ECHO"]
    assert window[register.address - STATUS_START :][: register.words] == words
    text = unpack(register, words)
    assert isinstance(text, str)
    assert text.isprintable()


def test_the_heartbeat_goes_on_through_a_long_part(plc: Driver) -> None:
    plc.trigger(1)
    before = plc.state.heartbeat
    silent = inputs(plc.control, 1, TIMES.deadline_s)
    assert step(plc.state, silent, plc.now + 0.2, TIMES).state.heartbeat == before + 1


def test_a_command_that_nobody_carries_out_is_refused_in_the_end(plc: Driver) -> None:
    plc.control, plc.command = ON | Control.EXEC_COMMAND, CommandCode.LOAD_RECIPE
    plc.step()
    plc.step(wait_s=TIMES.command_s + 1)
    assert plc.values()["CMD_ECHO"] == REFUSED
    assert Status.READY in plc.bits()
    assert plc.step(done=(1, True)).state.cmd_echo == REFUSED


def test_a_command_while_a_part_is_in_work_is_refused_and_the_part_goes_on(plc: Driver) -> None:
    plc.trigger(1)
    plc.control, plc.command = plc.control | Control.EXEC_COMMAND, CommandCode.LOAD_RECIPE
    plc.step()
    assert plc.commanded == []
    assert plc.values()["CMD_ECHO"] == REFUSED
    assert not plc.step(result(plc.started[-1])).refused


def test_abort_as_a_command(plc: Driver) -> None:
    plc.trigger(1)
    plc.control, plc.command = plc.control | Control.EXEC_COMMAND, CommandCode.ABORT
    plc.step()
    assert plc.values()["ERROR_CODE"] == 0x2102


def test_a_link_lost_for_long_ends_the_part_and_a_result_written_again_too_late_is_an_error(
    plc: Driver,
) -> None:
    plc.trigger(1)
    plc.step(result(plc.started[-1]))
    plc.step(wait_s=TIMES.deadline_s + 0.5, link_was_lost=True)
    assert (plc.values()["VERDICT"], plc.values()["ERROR_CODE"]) == (VerdictCode.ERROR, 0x2105)
    plc.step(link=False)
    assert plc.values()["VERDICT"] == 0
    assert plc.values()["OFFLINE_REASON"] == Offline.PLC_SILENT


def test_the_first_error_code_stays_until_cleared(plc: Driver) -> None:
    plc.trigger(1)
    plc.step(result(plc.started[-1], VerdictCode.ERROR))
    plc.control = ON | Control.RESULT_ACK
    for _ in range(60):
        plc.step(wait_s=0.1)
    assert plc.values()["ERROR_CODE"] == 0x1001


def test_camera_lost_says_why_not_ready(plc: Driver) -> None:
    plc.health = LOST
    plc.step()
    assert not ready(plc.state)
    assert plc.values()["OFFLINE_REASON"] == Offline.CAMERA_LOST
    assert Status.FAILURE in plc.bits()
    plc.health = WELL
    plc.step()
    assert Status.READY in plc.bits()


def test_stuck_acknowledge_is_released_with_an_alarm(plc: Driver) -> None:
    plc.control = ON | Control.RESULT_ACK
    plc.step()
    assert Status.READY not in plc.bits()
    for _ in range(60):
        plc.step(wait_s=0.1)
    assert plc.bits() & (Status.READY | Status.MAINTENANCE) == Status.READY | Status.MAINTENANCE


def test_clear_error(plc: Driver) -> None:
    plc.trigger(1)
    plc.step(result(plc.started[-1], VerdictCode.ERROR))
    assert Status.ERROR in plc.bits()
    plc.control = ON | Control.CLEAR_ERROR
    plc.step()
    assert Status.ERROR not in plc.bits()


def test_the_heartbeat_stands_still_when_the_inspection_does(plc: Driver) -> None:
    before = plc.state.heartbeat
    for _ in range(5):
        plc.step(wait_s=0.11)
    assert plc.state.heartbeat == before + 5
    silent = inputs(ON, 0, TIMES.alive_s + 1)
    stalled = step(plc.state, silent, plc.now + 1, TIMES).state
    assert stalled.heartbeat == plc.state.heartbeat
    assert stalled.offline is Offline.STATION_STALLED


class AnyInputs(RuleBasedStateMachine):
    """Random PLC, random station, random times. Results are offered for any trigger that ever started."""

    def __init__(self) -> None:
        super().__init__()
        self.plc = Driver()
        self.judged_ok: set[int] = set()

    @rule(control=st.integers(0, 255), trigger_id=st.integers(0, 4))
    def write(self, control: int, trigger_id: int) -> None:
        self.plc.control, self.plc.trigger_id = Control(control), trigger_id
        self.plc.step()

    @rule(trigger_id=st.integers(1, 4))
    def proper_trigger(self, trigger_id: int) -> None:
        self.plc.trigger(trigger_id)

    @rule(wait_s=st.sampled_from([0.01, 0.1, 1.0, 3.0, 12.0]), silent=st.booleans(), well=st.booleans())
    def wait(self, wait_s: float, silent: bool, well: bool) -> None:
        self.plc.silent, self.plc.health = silent, WELL if well else LOST
        self.plc.step(wait_s=wait_s)

    @rule(back=st.integers(0, 3), verdict=st.sampled_from(list(VerdictCode)[1:]))
    def offer(self, back: int, verdict: VerdictCode) -> None:
        if back < len(self.plc.started):
            trigger = self.plc.started[-1 - back]
            if verdict is VerdictCode.OK and self.plc.state.trigger == trigger:
                self.judged_ok.add(trigger.number)
            self.plc.step(result(trigger, verdict))

    @rule(code=st.sampled_from([0, 2, 7, 9, 11, 20, 21, 99]))
    def command(self, code: int) -> None:
        self.plc.command = code
        self.plc.control |= Control.EXEC_COMMAND
        self.plc.step()
        self.plc.control &= ~Control.EXEC_COMMAND

    @rule(back=st.integers(0, 2), well=st.booleans())
    def carried_out(self, back: int, well: bool) -> None:
        if back < len(self.plc.commanded):
            self.plc.step(done=(self.plc.commanded[-1 - back].number, well))

    @rule(wait_s=st.sampled_from([0.01, 1.0, 3.0]), back=st.booleans())
    def lose_the_link(self, wait_s: float, back: bool) -> None:
        self.plc.step(wait_s=wait_s, link=back, link_was_lost=True)

    @invariant()
    def ok_only_for_a_judged_frame(self) -> None:
        values, bits = self.plc.values(), self.plc.bits()
        assert values["SEQ_HEAD"] == values["SEQ_TAIL"]
        assert values["VERDICT"] ^ values["VERDICT_INV"] == 0xFFFF  # type: ignore[operator]
        assert not (Status.OK in bits and Status.NOK in bits)
        if Status.OK in bits:
            assert Status.RESULT_VALID in bits
            shown = self.plc.state.result
            assert shown is not None
            assert shown.trigger.number in self.judged_ok
            assert shown.trigger.number == self.plc.state.accepted, "a newer part was accepted since"
            assert values["RESULT_TRIGGER_ID"] == self.plc.state.last_id
        if Status.READY in bits:
            assert Status.BUSY not in bits
            assert Control.TRIGGER not in self.plc.state.control, "a held TRIGGER has no edge"

    @invariant()
    def there_is_a_way_out(self) -> None:
        spare = Driver()
        spare.state, spare.now, spare.beat = self.plc.state, self.plc.now, self.plc.beat
        for control in (Control(0), ON):
            spare.control = control
            for _ in range(3):
                spare.step(wait_s=TIMES.command_s + 1 if spare.state.command is not None else 0.01)
        assert Status.READY in spare.bits()


TestAnyInputs = AnyInputs.TestCase
TestAnyInputs.settings = settings(max_examples=60, stateful_step_count=40)
