"""Report of many records: counts, findings by kind and angle, trends, NOK parts, and what judged them."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from station.analysis.report.figures import Bars, ClockFace, Trend, angle_counts, bars, clock_face, trend
from station.analysis.report.strip import Gallery, StripImage, Weld, strip
from station.analysis.report.template import render
from station.analysis.truth import Errors, errors, interval
from station.analysis.worst_segment import worst_segment
from station.archive.reader import Listed
from station.domain import SEGMENT_DEG, Inspection, Purpose, Verdict
from station.errors import RecordError
from station.records import Record

Rows = tuple[tuple[str, str], ...]
"""Rows of a table, each with a name and a text."""

DOTS = 2000
"""Maximum number of parts in a trend; of more parts only every second, third, ... is drawn."""
GALLERY = 40
"""Maximum number of NOK parts that are shown with their weld, newest first."""
SEGMENT_TRENDS = {
    "mean_dn": "mean brightness (grey levels)",
    "contrast": "contrast",
    "sharpness": "sharpness",
    "saturated_fraction": "saturated fraction",
    "weld": "fraction with a weld",
    "visible": "visible fraction",
}
"""Values of the worst segment that have a trend."""
TEMPLATE = Path(__file__).with_name("page.html.j2")
"""Template of the report."""


@dataclass(frozen=True, slots=True)
class Found:
    """Counts of the reasons, and of the rejections of each segment."""

    reasons: Bars
    angles: ClockFace


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportPage:
    """Content of page.html.j2."""

    title: str
    summary: Rows
    truth: Rows | None
    """Errors against the truth; None if the truth is not known."""
    wrong: tuple[Gallery, ...]
    found: Found | None
    trends: tuple[Trend, ...]
    nok: Gallery | None
    judges: tuple[tuple[str, ...], ...]
    """Rows of the table of provenances, in the order of its heading."""
    problems: Rows


def report(
    entries: Sequence[Listed], folder: Path, title: str, truth: Mapping[str, str] | None = None
) -> str:
    """Return the report as HTML text; `truth` has the true verdicts by serial.

    Raises RecordError if there is no part among the entries.
    """
    unreadable = [(entry.path, entry.problem) for entry in entries if entry.problem is not None]
    parts = [
        (entry, entry.record)
        for entry in entries
        if entry.record is not None and entry.record.purpose is Purpose.PART
    ]
    records = [record for _, record in parts]
    if not records:
        raise RecordError(f"{folder}: the chosen records contain no parts; choose others")
    found = None if truth is None else _against_truth(records, truth)
    page = ReportPage(
        title=title,
        summary=_summary(records, sum(entry.shown_to_plc is False for entry, _ in parts)),
        truth=None if found is None else truth_rows(found),
        wrong=() if found is None else _wrong(records, folder, found),
        found=_found(records),
        trends=_trends(records),
        nok=_nok(records, folder),
        judges=_judges(records),
        problems=tuple((path.name, str(problem)) for path, problem in unreadable),
    )
    return render(TEMPLATE, page)


def truth_rows(found: Errors) -> Rows:
    """Return the numbers of escapes, false rejects and unjudged parts, with confidence intervals."""
    return (
        ("escapes (NOK judged OK)", _fraction(len(found.escapes), found.nok)),
        ("false rejects (OK judged NOK)", _fraction(len(found.false_rejects), found.ok)),
        ("not judged", _fraction(len(found.not_judged), found.ok + found.nok)),
    )


def _fraction(count: int, total: int) -> str:
    low, high = interval(count, total)
    if not total:
        return "no such part"
    return f"{count} of {total}, {count / total:.1%} (95 %: {low:.1%} to {high:.1%})"


def _against_truth(records: Sequence[Record], truth: Mapping[str, str]) -> Errors:
    return errors(truth, {serial: str(record.verdict) for serial, record in _by_serial(records).items()})


def _by_serial(records: Sequence[Record]) -> dict[str, Record]:
    return {record.serial: record for record in records}  # for a part that was judged twice, the last record


def _wrong(records: Sequence[Record], folder: Path, found: Errors) -> tuple[Gallery, ...]:
    by_serial = _by_serial(records)
    return tuple(
        Gallery(title, tuple(_weld(by_serial[serial], folder) for serial in serials[:GALLERY]))
        for title, serials in (("Escapes", found.escapes), ("False rejects", found.false_rejects))
        if serials
    )


def _summary(records: Sequence[Record], not_shown: int) -> Rows:
    counts = Counter(record.verdict for record in records)
    first, last = (f"{records[i].grabbed_at:%Y-%m-%d %H:%M:%S} UTC" for i in (0, -1))
    return (
        ("from", first),
        ("to", last),
        ("parts", str(len(records))),
        *((str(verdict), str(counts[verdict])) for verdict in Verdict),
        ("yield", f"{counts[Verdict.OK] / len(records):.1%}"),
        ("not shown to the PLC", str(not_shown)),
    )


def _found(records: Sequence[Record]) -> Found | None:
    reasons = Counter(
        str(record.inspection.reason) for record in records if record.inspection.reason is not None
    )
    judged = [
        [kind is not None for kind in record.inspection.rejected]
        for record in records
        if record.inspection.scores
    ]
    return Found(bars(list(reasons.items())), clock_face(angle_counts(judged))) if reasons else None


def _trends(records: Sequence[Record]) -> tuple[Trend, ...]:
    records = records[:: -(-len(records) // DOTS)]
    bad = [record.verdict is not Verdict.OK for record in records]
    inspections = [record.inspection for record in records]
    limit = records[-1].provenance.thresholds.lowest
    return (
        trend(
            [i.worst for i in inspections],
            bad,
            "highest score of NOK",
            limit,
        ),
        trend(
            [None if i.quality is None else i.quality.mean_dn for i in inspections],
            bad,
            "mean brightness (grey levels)",
        ),
        trend([None if i.quality is None else i.quality.sharpness for i in inspections], bad, "sharpness"),
        trend([i.novelty for i in inspections], bad, "novelty (distance to the training images)"),
        *_segment_trends(inspections, bad),
    )


def _segment_trends(inspections: Sequence[Inspection], bad: Sequence[bool]) -> Iterator[Trend]:
    """Yield a trend of the worst segment in each value that is known of any part."""
    worst = [worst_segment(inspection) for inspection in inspections]
    for field, words in SEGMENT_TRENDS.items():
        values = [None if quality is None else getattr(quality, field) for quality in worst]
        if any(value is not None for value in values):
            yield trend(values, bad, f"worst segment: {words}")


def _nok(records: Sequence[Record], folder: Path) -> Gallery | None:
    nok = [record for record in records if record.verdict is Verdict.NOK]
    if not nok:
        return None
    shown = nok[-GALLERY:][::-1]
    count = f", the last {len(shown)} of {len(nok)}" if len(shown) < len(nok) else ""
    return Gallery(f"NOK parts{count}", tuple(_weld(record, folder) for record in shown))


def _weld(record: Record, folder: Path) -> Weld:
    found = [
        f"{finding.kind} at {finding.start_deg:.0f}°, {finding.length_mm:.2f} mm long"
        + ("" if finding.area_mm2 is None else f", {finding.area_mm2:.2f} mm²")
        for finding in record.inspection.findings
    ] or [str(record.verdict)]
    result = "; ".join(found + ([record.inspection.detail] if record.inspection.detail else []))
    text = f"{record.serial}, {record.grabbed_at:%Y-%m-%d %H:%M:%S}: {result}"
    return Weld(str(record.inspection_id), text, _strip(record, folder))


def _strip(record: Record, folder: Path) -> StripImage:
    rejected = (
        (i * SEGMENT_DEG, (i + 1) * SEGMENT_DEG)
        for i, kind in enumerate(record.inspection.rejected)
        if kind is not None
    )
    path = None if record.frame_file is None else folder / record.frame_file
    return strip(path, record.inspection.ring, rejected, um_per_px=record.provenance.um_per_px)


def _judges(records: Sequence[Record]) -> tuple[tuple[str, ...], ...]:
    judges = Counter(record.provenance for record in records)
    return tuple(
        (
            str(count),
            judge.software,
            str(judge.recipe),
            judge.model_version,
            judge.model_hash[:16],
            judge.limits,
            str(judge.config_crc),
        )
        for judge, count in judges.items()
    )
