"""What a lot or a shift brought: counts, where and what was found, trends, the NOK parts, who judged."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from station.analysis.report.figures import Bars, ClockFace, Trend, angle_counts, bars, clock_face, trend
from station.analysis.report.strip import Gallery, StripImage, Weld, strip
from station.analysis.report.template import render
from station.analysis.truth import Errors, errors, interval
from station.archive.reader import Listed
from station.domain import SEGMENT_DEG, Purpose, Verdict
from station.errors import RecordError
from station.records import Record

Rows = tuple[tuple[str, str], ...]
"""Lines of a table: a name and a text each."""

DOTS = 2000
"""Parts in a trend; of more, every second, third and so on."""
GALLERY = 40
"""NOK parts shown with their weld, the newest."""
TEMPLATE = Path(__file__).with_name("page.html.j2")


@dataclass(frozen=True, slots=True)
class Found:
    """How often each reason was given, and each segment was NOK."""

    reasons: Bars
    angles: ClockFace


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportPage:
    """What page.html.j2 lays out; rows are pairs of a name and a text."""

    title: str
    summary: Rows
    truth: Rows | None
    """None: the truth is not known."""
    wrong: tuple[Gallery, ...]
    found: Found | None
    trends: tuple[Trend, ...]
    nok: Gallery | None
    judges: tuple[tuple[str, ...], ...]
    """Number of parts, software, recipe, model and so on, as the table is headed."""
    problems: Rows


def report(
    entries: Sequence[Listed], folder: Path, title: str, truth: Mapping[str, str] | None = None
) -> str:
    """Return the page as HTML text; `truth`: what the serials are.

    Raises RecordError if no part is among the entries.
    """
    unreadable = [(e.path, e.problem) for e in entries if e.problem is not None]
    records = [e.record for e in entries if e.record is not None and e.record.purpose is Purpose.PART]
    if not records:
        raise RecordError(f"{folder}: no parts among the chosen records; choose others")
    parts = [e for e in entries if e.record is not None and e.record.purpose is Purpose.PART]
    found = None if truth is None else _against_truth(records, truth)
    page = ReportPage(
        title=title,
        summary=_summary(records, sum(e.shown_to_plc is False for e in parts)),
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
    """Both kinds of error, with their intervals."""
    return (
        ("escapes (NOK judged OK)", _share(len(found.escapes), found.nok)),
        ("false rejects (OK judged NOK)", _share(len(found.false_rejects), found.ok)),
        ("not judged", _share(len(found.not_judged), found.ok + found.nok)),
    )


def _share(count: int, of: int) -> str:
    low, high = interval(count, of)
    return f"{count} of {of}, {count / of:.1%} (95 %: {low:.1%} to {high:.1%})" if of else "no such part"


def _against_truth(records: Sequence[Record], truth: Mapping[str, str]) -> Errors:
    return errors(truth, {serial: str(record.verdict) for serial, record in _by_serial(records).items()})


def _by_serial(records: Sequence[Record]) -> dict[str, Record]:
    return {record.serial: record for record in records}  # of a part that was judged twice, the last


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
        *((str(v), str(counts[v])) for v in Verdict),
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
            [max((s.nok for s in i.scores), default=None) for i in inspections],
            bad,
            "worst score of NOK",
            limit,
        ),
        trend(
            [None if i.quality is None else i.quality.mean_dn for i in inspections],
            bad,
            "brightness, grey levels",
        ),
        trend([None if i.quality is None else i.quality.sharpness for i in inspections], bad, "sharpness"),
        trend([i.novelty for i in inspections], bad, "distance to the training images"),
    )


def _nok(records: Sequence[Record], folder: Path) -> Gallery | None:
    nok = [record for record in records if record.verdict is Verdict.NOK]
    if not nok:
        return None
    shown = nok[-GALLERY:][::-1]
    count = f", the last {len(shown)} of {len(nok)}" if len(shown) < len(nok) else ""
    return Gallery(f"NOK parts{count}", tuple(_weld(record, folder) for record in shown))


def _weld(record: Record, folder: Path) -> Weld:
    said = "; ".join(
        f"{f.kind} at {f.start_deg:.0f}°, {f.length_mm:.2f} mm long"
        + ("" if f.area_mm2 is None else f", {f.area_mm2:.2f} mm²")
        for f in record.inspection.findings
    ) or str(record.verdict)
    text = f"{record.serial}, {record.grabbed_at:%Y-%m-%d %H:%M:%S}: {said}"
    return Weld(str(record.inspection_id), text, _strip(record, folder))


def _strip(record: Record, folder: Path) -> StripImage:
    refused = (
        (i * SEGMENT_DEG, (i + 1) * SEGMENT_DEG)
        for i, kind in enumerate(record.inspection.rejected)
        if kind is not None
    )
    return strip(
        None if record.frame_file is None else folder / record.frame_file, record.inspection.ring, refused
    )


def _judges(records: Sequence[Record]) -> tuple[tuple[str, ...], ...]:
    judges = Counter(record.provenance for record in records)
    return tuple(
        (
            str(count),
            p.software,
            str(p.recipe),
            p.model_version,
            p.model_hash[:16],
            p.limits,
            str(p.config_crc),
        )
        for p, count in judges.items()
    )
