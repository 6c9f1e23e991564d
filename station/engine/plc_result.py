"""Converts a record to the result for the PLC; pure."""

from station.domain import Origin, Purpose, Verdict
from station.plc.map.registers import ALL_SEGMENTS, ERROR_NOT_JUDGED, Flags, VerdictCode
from station.plc.port import Result, Trigger
from station.records import Record


def verdict_code(record: Record, trusted: bool) -> VerdictCode:
    """Return the verdict for the PLC.

    A replayed part or a master is never released, nor is any part while the station is not `trusted`.
    """
    if record.verdict is Verdict.ERROR:
        return VerdictCode.ERROR
    if record.purpose is not Purpose.PART or record.origin is Origin.REPLAY:
        return VerdictCode.TEST
    if record.verdict is Verdict.OK:
        return VerdictCode.OK if trusted else VerdictCode.TEST
    return VerdictCode.NOK


def plc_result(
    trigger: Trigger,
    record: Record,
    *,
    novel: bool,
    drifting: bool,
    trusted: bool,
) -> Result:
    """Return the result to publish for a trigger.

    `novel`, `drifting`: flags for the PLC; `trusted`: the self-checks allow an OK.
    """
    inspection = record.inspection
    reason = 0 if inspection.reason is None else inspection.reason.code
    flags = (
        (Flags.SIMULATED, record.origin is Origin.SIMULATED),
        (Flags.NOVEL, novel),
        (Flags.DRIFT, drifting),
    )
    return Result(
        trigger=trigger,
        verdict=verdict_code(record, trusted),
        inspection_id=record.inspection_id,
        reason=reason,
        error_code=ERROR_NOT_JUDGED + reason if inspection.verdict is Verdict.ERROR else 0,
        seg_scores=tuple(
            0 if score is None else round(min(max(score, 0.0), 1.0) * 10_000)
            for score in inspection.nok_scores
        ),
        seg_nok_mask=_mask(inspection.nok),
        seg_invalid_mask=_mask(inspection.invalid) if inspection.scores else ALL_SEGMENTS,
        flags=Flags(sum(flag for flag, active in flags if active)),
    )


def _mask(segments: tuple[bool, ...]) -> int:
    return sum(1 << index for index, chosen in enumerate(segments) if chosen)
