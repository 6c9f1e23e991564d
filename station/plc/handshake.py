"""The handshake as a pure state machine: inputs and time in, outputs out. No device, no clock.

    OFFLINE --enabled, healthy, PLC alive--> IDLE
    IDLE --TRIGGER edge, new id--> WIPED        the old result is gone, TRIGGER_ACK still 0
    WIPED --next step--> BUSY                   TRIGGER_ACK = 1, inspection starts
    BUSY --result, deadline or ABORT--> SHOWN   RESULT_VALID = 1
    SHOWN --RESULT_ACK edge, TTL, or next trigger--> IDLE (or WIPED)
    any --ENABLE = 0, SET_OFFLINE, PLC silent--> OFFLINE   result wiped

A command that the station must carry out holds READY at 0 until it is done. A verdict is shown only for the trigger in work; a result
of any other trigger is refused.
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
    """One step. Publish `status_window.values(step.state, ...)` before acting on the rest of the outcome."""
    rising = inputs.control & ~state.control
    was_ready = ready(state)
    s = _clocks(state, inputs, now_s, times)
    s = replace(s, control=inputs.control)
    s = _acknowledge(s, inputs, rising, now_s=now_s, times=times)
    s, rising, command = _commanded(s, inputs, rising, now_s=now_s, times=times)
    offline = _offline(s, inputs, now_s, times)
    s = replace(s, offline=offline)
    start: Trigger | None = None
    refused = inputs.result is not None

    if offline in (Offline.NOT_ENABLED, Offline.SET_OFFLINE, Offline.PLC_SILENT, Offline.PREPARING):
        s = _wiped(replace(s, phase=Phase.OFFLINE, trigger=None, trigger_ack=False))
        if rising & Control.TRIGGER:
            s = replace(s, missed=True)
        return Step(state=s, command=command, refused=refused)

    if s.phase is Phase.WIPED and s.trigger is not None:
        start = s.trigger
        s = replace(s, phase=Phase.BUSY, trigger_ack=True)
    elif s.phase is Phase.BUSY and s.trigger is not None:
        s, refused = _busy(s, s.trigger, inputs, rising, now_s=now_s, times=times)
    elif s.phase is Phase.SHOWN and (shown := s.result) is not None:
        if now_s - s.shown_s > times.result_ttl_s:
            s = _wiped(replace(s, phase=Phase.IDLE))
        elif inputs.link_was_lost and now_s - shown.trigger.accepted_s > times.deadline_s:
            trigger = shown.trigger
            s = _shown(s, _error_result(trigger, Reason.DEADLINE.code, codes.ERROR_LINK_LOST), trigger, now_s)

    if s.phase is Phase.OFFLINE and offline is Offline.NONE:
        s = replace(s, phase=Phase.IDLE)
    elif s.phase is Phase.IDLE and offline is not Offline.NONE:
        s = replace(s, phase=Phase.OFFLINE)
    if start is None and rising & Control.TRIGGER:
        s = _triggered(s, inputs, now_s, was_ready)
    return Step(state=s, start=start, command=command, refused=refused, again=s.phase is Phase.WIPED)


def ready(s: State) -> bool:
    """Whether a trigger would be accepted now."""
    waiting = not (s.control & Control.RESULT_ACK) or s.stuck
    return (
        s.offline is Offline.NONE and s.phase in (Phase.IDLE, Phase.SHOWN) and waiting and not s.trigger_ack
    )


def _clocks(s: State, inputs: Inputs, now_s: float, times: Times) -> State:
    if inputs.plc_heartbeat != s.plc_heartbeat:
        s = replace(s, plc_heartbeat=inputs.plc_heartbeat, plc_seen_s=now_s)
    patience_s = max(times.alive_s, times.deadline_s) if s.phase is Phase.BUSY else times.alive_s
    if inputs.health_age_s <= patience_s and inputs.health.ready and now_s - s.heartbeat_s >= 0.1:
        s = replace(s, heartbeat=(s.heartbeat + 1) & 0xFFFF, heartbeat_s=now_s)
    if not (s.control & Control.TRIGGER) and inputs.control & Control.TRIGGER:
        s = replace(s, trigger_since_s=now_s)
    if not (s.control & Control.RESULT_ACK) and inputs.control & Control.RESULT_ACK:
        s = replace(s, ack_since_s=now_s)
    held = (
        inputs.control & s.control & Control.TRIGGER
        and s.phase is not Phase.BUSY
        and now_s - s.trigger_since_s > max(times.stuck_s, times.deadline_s)
    ) or (inputs.control & s.control & Control.RESULT_ACK and now_s - s.ack_since_s > times.stuck_s)
    newly = bool(held) and not s.stuck
    return replace(s, stuck=bool(held), error_code=s.error_code or (codes.ERROR_STUCK_BIT if newly else 0))


def _acknowledge(s: State, inputs: Inputs, rising: Control, *, now_s: float, times: Times) -> State:
    if not inputs.control & Control.TRIGGER or (s.stuck and now_s - s.trigger_since_s > times.stuck_s):
        s = replace(s, trigger_ack=False)
    if rising & Control.RESULT_ACK and s.phase is Phase.SHOWN:
        s = _wiped(replace(s, phase=Phase.IDLE))
    if rising & Control.CLEAR_ERROR:
        s = replace(s, error=False, missed=False, error_code=0)
    return s


def _commanded(
    s: State,
    inputs: Inputs,
    rising: Control,
    *,
    now_s: float,
    times: Times,
) -> tuple[State, Control, Command | None]:
    """The state with the command heard, the edges with what it stands for, and what the station must do."""
    if s.command is not None:
        done = inputs.command_done is not None and inputs.command_done[0] == s.command.number
        if done or now_s - s.command.since_s > times.command_s:
            well = done and inputs.command_done is not None and inputs.command_done[1]
            s = replace(s, cmd_done=True, cmd_echo=s.command.code if well else REFUSED, command=None)
    if not inputs.control & Control.EXEC_COMMAND:
        return replace(s, cmd_done=False), rising, None
    if not rising & Control.EXEC_COMMAND:
        return s, rising, None
    code, command = inputs.command, None
    if code in (CommandCode.RESET, CommandCode.ACK_ERROR):
        s = replace(s, error=False, missed=False, error_code=0)
        if code == CommandCode.RESET and s.phase is Phase.SHOWN:
            s = _wiped(replace(s, phase=Phase.IDLE))
    elif code == CommandCode.ABORT:
        rising |= Control.ABORT
    elif code in (CommandCode.RESET_COUNTERS, CommandCode.TIME_SYNC):
        command = Command(CommandCode(code), inputs.arg, s.commands + 1, now_s)
        s = replace(s, commands=command.number)
    elif code == CommandCode.LOAD_RECIPE and s.command is None and s.phase in (Phase.OFFLINE, Phase.IDLE):
        command = Command(CommandCode.LOAD_RECIPE, inputs.arg, s.commands + 1, now_s)
        return replace(s, cmd_done=False, command=command, commands=command.number), rising, command
    else:
        code = REFUSED
    return replace(s, cmd_done=True, cmd_echo=code), rising, command


def _offline(s: State, inputs: Inputs, now_s: float, times: Times) -> Offline:
    if not inputs.link:
        return Offline.PLC_SILENT
    if times.plc_heartbeat_s > 0 and now_s - s.plc_seen_s > times.plc_heartbeat_s:
        return Offline.PLC_SILENT
    if inputs.control & Control.SET_OFFLINE:
        return Offline.SET_OFFLINE
    if not inputs.control & Control.ENABLE:
        return Offline.NOT_ENABLED
    if inputs.health_age_s > times.alive_s and s.phase is not Phase.BUSY:
        return Offline.STATION_STALLED
    if s.command is not None:
        return Offline.PREPARING
    return Offline.NONE if inputs.health.ready else inputs.health.offline


def _busy(
    s: State,
    trigger: Trigger,
    inputs: Inputs,
    rising: Control,
    *,
    now_s: float,
    times: Times,
) -> tuple[State, bool]:
    if inputs.exposure_done_for == trigger.number:
        s = replace(s, exposure_done=True)
    late = now_s - trigger.accepted_s > times.deadline_s
    if late or rising & Control.ABORT:
        why, code = (Reason.DEADLINE, codes.ERROR_DEADLINE) if late else (Reason.ABORTED, codes.ERROR_ABORTED)
        return _shown(s, _error_result(trigger, why.code, code), trigger, now_s), inputs.result is not None
    if inputs.result is not None and inputs.result.trigger == trigger:
        return _shown(s, inputs.result, trigger, now_s), False
    return s, inputs.result is not None


def _shown(s: State, result: Result, trigger: Trigger, now_s: float) -> State:
    failed = result.verdict is VerdictCode.ERROR
    return replace(
        s,
        phase=Phase.SHOWN,
        result=result,
        trigger=None,
        shown_s=now_s,
        process_ms=min(0xFFFF, int((now_s - trigger.accepted_s) * 1000)),
        sequence=(s.sequence + 1) & 0xFFFF,
        error=s.error or failed,
        error_code=result.error_code if failed else s.error_code,
    )


def _wiped(s: State) -> State:
    if s.result is None:
        return s
    return replace(s, result=None, sequence=(s.sequence + 1) & 0xFFFF)


def _triggered(s: State, inputs: Inputs, now_s: float, was_ready: bool) -> State:
    """READY must have been readable before the edge, and still hold."""
    if not (was_ready and ready(s)):
        return replace(s, missed=True)
    if inputs.trigger_id in (0, s.last_id):
        return replace(s, missed=True, error_code=s.error_code or codes.ERROR_BAD_TRIGGER_ID)
    golden = bool(inputs.control & Control.GOLDEN_CHECK)
    trigger = Trigger(inputs.trigger_id, inputs.serial, now_s, s.accepted + 1, golden=golden)
    s = replace(_wiped(s), accepted=trigger.number)
    return replace(
        s, phase=Phase.WIPED, trigger=trigger, last_id=inputs.trigger_id, exposure_done=False, missed=False
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
