"""What an integrator does about each value of Refusal."""

from station.plc.block.definition import (
    MAX_AGE_10MS,
    NO_RESULT,
    NOT_READY,
    POINTS,
    REFUSALS,
    START_AGAIN,
)

_POINTS = (
    "Look at HEARTBEAT: if it stands still, the station inspects nothing (OFFLINE_REASON). If it moves, the "
    "window is read too seldom: give HeartbeatTime at least three reads.",
    "Only if the window is put together by hand: read it in one request.",
    "The part is NOK, was not judged or is a master. Sort it out by Result.VERDICT: 2 NOK, 3 ERROR "
    "(Result.ERROR_CODE says why), 4 TEST.",
    "As 3. With VERDICT 1 the words lie at wrong places: check address and length of the read.",
    "The window was read in several requests while it changed: read it in one.",
    "Two writers, or a second block with the same number: only one may write the command window.",
    "Serial was changed while the part was in work, or its bytes were exchanged on the way.",
    "Set Recipe to the number of the recipe that this part needs, or load it with command 2.",
    "Set Crc to CONFIG_CRC of the released settings, or take the change of the settings back.",
    f"The window is older than {MAX_AGE_10MS // 100} s: the link is slow or the block was not called.",
    "FAILURE or FUNCTION_CHECK: see ERROR_CODE. A master that is wrong or due sets FUNCTION_CHECK.",
    "A demonstration without a camera: set AcceptSimulated. In production never.",
    "The station runs with model.novel = flag: judge the part by hand, or set AcceptNovel.",
)
ADVICE: dict[int, str] = {
    **dict(enumerate(_POINTS, start=1)),
    NOT_READY: "OFFLINE_REASON says why READY is 0. Start only while Ready is TRUE. If READY is 1, no "
    "heartbeat was seen: set Fresh, and call the block in each cycle.",
    NO_RESULT: "TRIGGER or the result did not arrive within WindowTime: look at the link, and make "
    "WindowTime longer than plc.deadline_ms of the station.",
    START_AGAIN: "The program raised Start before PartDone. The part in work is refused, the next one was "
    "not begun: bring it again.",
}
"""What to do, by value of Refusal."""
if sorted(ADVICE) != list(range(1, len(REFUSALS))) or len(_POINTS) != len(POINTS):
    raise ValueError("each value of Refusal needs an advice")
