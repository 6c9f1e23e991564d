"""The handshake as a pure state machine without device or clock: inputs and time in, outputs out.

    OFFLINE --enabled, healthy, PLC alive--> IDLE
    IDLE --TRIGGER edge, new id--> WIPED        the old result is wiped, TRIGGER_ACK still 0
    WIPED --next step--> BUSY                   TRIGGER_ACK = 1, inspection starts
    BUSY --result, deadline or ABORT--> SHOWN   RESULT_VALID = 1
    SHOWN --RESULT_ACK edge, TTL, or next trigger--> IDLE (or WIPED)
    any --ENABLE = 0, SET_OFFLINE, PLC silent--> OFFLINE   result wiped

A command that the station must carry out holds READY at 0 until it is done. A verdict is shown only for the
trigger in progress; a result for any other trigger is refused.
"""

from dataclasses import replace

from station.defects import Reason
from station.plc.handshake_state import Inputs, Phase, State, Step, Times
from station.plc.map import codes
from station.plc.map.registers import (
    ALL_SEGMENTS,
    REFUSED,
    CommandCode,
    Control,
    Flags,
    Offline,
    VerdictCode,
)
from station.plc.port import Command, Result, Trigger


def step(state: State, inputs: Inputs, now_s: float, times: Times) -> Step:
    """Return the outcome of one step.

    Publish `status_window.values(step.state, ...)` before acting on the rest of the outcome.
    """
    rising = inputs.control & ~state.control
    was_ready = ready(state)
    state = _clocks(state, inputs, now_s, times)
    state = replace(state, control=inputs.control)
    state = _acknowledge(state, inputs, rising, now_s=now_s, times=times)
    state, rising, command = _commanded(state, inputs, rising, now_s=now_s, times=times)
    offline = _offline(state, inputs, now_s, times)
    state = replace(state, offline=offline)
    start: Trigger | None = None
    refused = inputs.result is not None

    if offline in (Offline.NOT_ENABLED, Offline.SET_OFFLINE, Offline.PLC_SILENT, Offline.PREPARING):
        state = _wiped(replace(state, phase=Phase.OFFLINE, trigger=None, trigger_ack=False))
        if rising & Control.TRIGGER:
            state = replace(state, missed=True)
        return Step(state=state, command=command, refused=refused)

    if state.phase is Phase.WIPED and state.trigger is not None:
        start = state.trigger
        state = replace(state, phase=Phase.BUSY, trigger_ack=True)
    elif state.phase is Phase.BUSY and state.trigger is not None:
        state, refused = _busy(state, state.trigger, inputs, rising, now_s=now_s, times=times)
    elif state.phase is Phase.SHOWN and (shown := state.result) is not None:
        if now_s - state.shown_s > times.result_ttl_s:
            state = _wiped(replace(state, phase=Phase.IDLE))
        elif inputs.link_was_lost and now_s - shown.trigger.accepted_s > times.deadline_s:
            trigger = shown.trigger
            lost = _error_result(trigger, Reason.DEADLINE.code, codes.ERROR_LINK_LOST)
            state = _shown(state, lost, trigger, now_s)

    if state.phase is Phase.OFFLINE and offline is Offline.NONE:
        state = replace(state, phase=Phase.IDLE)
    elif state.phase is Phase.IDLE and offline is not Offline.NONE:
        state = replace(state, phase=Phase.OFFLINE)
    if start is None and rising & Control.TRIGGER:
        state = _triggered(state, inputs, now_s, was_ready)
    return Step(state=state, start=start, command=command, refused=refused, again=state.phase is Phase.WIPED)


def ready(state: State) -> bool:
    """Return whether the next rising edge of TRIGGER would be accepted.

    Not while TRIGGER is held: a PLC that drops it and raises it again between two reads shows no edge.
    """
    return _free(state) and not state.control & Control.TRIGGER


def _free(state: State) -> bool:
    ack_released = not (state.control & Control.RESULT_ACK) or state.stuck
    return (
        state.offline is Offline.NONE
        and state.phase in (Phase.IDLE, Phase.SHOWN)
        and ack_released
        and not state.trigger_ack
    )


def _clocks(state: State, inputs: Inputs, now_s: float, times: Times) -> State:
    if inputs.plc_heartbeat != state.plc_heartbeat:
        state = replace(state, plc_heartbeat=inputs.plc_heartbeat, plc_seen_s=now_s)
    patience_s = max(times.alive_s, times.deadline_s) if state.phase is Phase.BUSY else times.alive_s
    if inputs.health_age_s <= patience_s and inputs.health.ready and now_s - state.heartbeat_s >= 0.1:
        state = replace(state, heartbeat=(state.heartbeat + 1) & 0xFFFF, heartbeat_s=now_s)
    if not (state.control & Control.TRIGGER) and inputs.control & Control.TRIGGER:
        state = replace(state, trigger_since_s=now_s)
    if not (state.control & Control.RESULT_ACK) and inputs.control & Control.RESULT_ACK:
        state = replace(state, ack_since_s=now_s)
    held = (
        inputs.control & state.control & Control.TRIGGER
        and state.phase is not Phase.BUSY
        and now_s - state.trigger_since_s > max(times.stuck_s, times.deadline_s)
    ) or (inputs.control & state.control & Control.RESULT_ACK and now_s - state.ack_since_s > times.stuck_s)
    new_error = codes.ERROR_STUCK_BIT if held and not state.stuck else 0
    return replace(state, stuck=bool(held), error_code=state.error_code or new_error)


def _acknowledge(state: State, inputs: Inputs, rising: Control, *, now_s: float, times: Times) -> State:
    if not inputs.control & Control.TRIGGER or (
        state.stuck and now_s - state.trigger_since_s > times.stuck_s
    ):
        state = replace(state, trigger_ack=False)
    if rising & Control.RESULT_ACK and state.phase is Phase.SHOWN:
        state = _wiped(replace(state, phase=Phase.IDLE))
    if rising & Control.CLEAR_ERROR:
        state = replace(state, error=False, missed=False, error_code=0)
    return state


def _commanded(
    state: State,
    inputs: Inputs,
    rising: Control,
    *,
    now_s: float,
    times: Times,
) -> tuple[State, Control, Command | None]:
    """Return the state after a command, the rising edges including its own, and what the station must do."""
    if state.command is not None:
        done = inputs.command_done is not None and inputs.command_done[0] == state.command.number
        if done or now_s - state.command.since_s > times.command_s:
            succeeded = done and inputs.command_done is not None and inputs.command_done[1]
            echo = state.command.code if succeeded else REFUSED
            state = replace(state, cmd_done=True, cmd_echo=echo, command=None)
    if not inputs.control & Control.EXEC_COMMAND:
        return replace(state, cmd_done=False), rising, None
    if not rising & Control.EXEC_COMMAND:
        return state, rising, None
    code, command = inputs.command, None
    if code in (CommandCode.RESET, CommandCode.ACK_ERROR):
        state = replace(state, error=False, missed=False, error_code=0)
        if code == CommandCode.RESET and state.phase is Phase.SHOWN:
            state = _wiped(replace(state, phase=Phase.IDLE))
    elif code == CommandCode.ABORT:
        rising |= Control.ABORT
    elif code == CommandCode.RESET_COUNTERS or (code == CommandCode.TIME_SYNC and inputs.plc_time_s > 0):
        command = Command(CommandCode(code), inputs.arg, state.commands + 1, now_s)
        state = replace(state, commands=command.number)
    elif (
        code == CommandCode.LOAD_RECIPE
        and state.command is None
        and state.phase in (Phase.OFFLINE, Phase.IDLE)
    ):
        command = Command(CommandCode.LOAD_RECIPE, inputs.arg, state.commands + 1, now_s)
        return replace(state, cmd_done=False, command=command, commands=command.number), rising, command
    else:
        code = REFUSED
    return replace(state, cmd_done=True, cmd_echo=code), rising, command


def _offline(state: State, inputs: Inputs, now_s: float, times: Times) -> Offline:
    if not inputs.link:
        return Offline.PLC_SILENT
    if times.plc_heartbeat_s > 0 and now_s - state.plc_seen_s > times.plc_heartbeat_s:
        return Offline.PLC_SILENT
    if inputs.control & Control.SET_OFFLINE:
        return Offline.SET_OFFLINE
    if not inputs.control & Control.ENABLE:
        return Offline.NOT_ENABLED
    if inputs.health_age_s > times.alive_s and state.phase is not Phase.BUSY:
        return Offline.STATION_STALLED
    if state.command is not None:
        return Offline.PREPARING
    return Offline.NONE if inputs.health.ready else inputs.health.offline


def _busy(
    state: State,
    trigger: Trigger,
    inputs: Inputs,
    rising: Control,
    *,
    now_s: float,
    times: Times,
) -> tuple[State, bool]:
    if inputs.exposure_done_for == trigger.number:
        state = replace(state, exposure_done=True)
    late = now_s - trigger.accepted_s > times.deadline_s
    if late or rising & Control.ABORT:
        why, code = (Reason.DEADLINE, codes.ERROR_DEADLINE) if late else (Reason.ABORTED, codes.ERROR_ABORTED)
        failed = _error_result(trigger, why.code, code)
        return _shown(state, failed, trigger, now_s), inputs.result is not None
    if inputs.result is not None and inputs.result.trigger == trigger:
        return _shown(state, inputs.result, trigger, now_s), False
    return state, inputs.result is not None


def _shown(state: State, result: Result, trigger: Trigger, now_s: float) -> State:
    failed = result.verdict is VerdictCode.ERROR
    return replace(
        state,
        phase=Phase.SHOWN,
        result=result,
        trigger=None,
        shown_s=now_s,
        process_ms=min(0xFFFF, int((now_s - trigger.accepted_s) * 1000)),
        sequence=(state.sequence + 1) & 0xFFFF,
        error=state.error or failed,
        error_code=result.error_code if failed else state.error_code,
    )


def _wiped(state: State) -> State:
    if state.result is None:
        return state
    return replace(state, result=None, sequence=(state.sequence + 1) & 0xFFFF)


def _triggered(state: State, inputs: Inputs, now_s: float, was_ready: bool) -> State:
    """Accept a trigger; READY must have been readable before the edge and must still hold."""
    if not (was_ready and _free(state)):
        return replace(state, missed=True)
    if inputs.trigger_id in (0, state.last_id):
        return replace(state, missed=True, error_code=state.error_code or codes.ERROR_BAD_TRIGGER_ID)
    golden = bool(inputs.control & Control.GOLDEN_CHECK)
    trigger = Trigger(
        inputs.trigger_id,
        inputs.serial,
        now_s,
        state.accepted + 1,
        golden=golden,
        serial_words=inputs.serial_words,
    )
    state = replace(_wiped(state), accepted=trigger.number)
    return replace(
        state,
        phase=Phase.WIPED,
        trigger=trigger,
        last_id=inputs.trigger_id,
        exposure_done=False,
        missed=False,
    )


def _error_result(trigger: Trigger, reason: int, code: int) -> Result:
    return Result(
        trigger=trigger,
        verdict=VerdictCode.ERROR,
        inspection_id=0,
        reason=reason,
        error_code=code,
        seg_scores=(),
        seg_nok_mask=0,
        seg_invalid_mask=ALL_SEGMENTS,
        flags=Flags(0),
    )
