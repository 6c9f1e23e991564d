"""What a lot or a shift brought: counts, where and what was found, trends, the NOK parts, who judged."""

from collections import Counter
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from station.archive.reader import Listed
from station.domain import SEGMENT_DEG, Purpose, Verdict
from station.errors import RecordError
from station.records import Record
from station.report.figures import angle_counts, bars, clock_face, trend
from station.report.strip import strip
from station.report.truth import Errors, errors, interval

DOTS = 2000
"""Parts in a trend; of more, every second, third and so on."""
GALLERY = 40
"""NOK parts shown with their weld, the newest."""
STYLE = (
    "body{font:15px/1.45 system-ui,sans-serif;color:#23272d;max-width:1080px;margin:2em auto;padding:0 1em}"
    "table{border-collapse:collapse}td,th{border:1px solid #ccc;padding:.3em .8em;text-align:left}"
    ".row{display:flex;flex-wrap:wrap;gap:2em;align-items:flex-start}figure{margin:1.2em 0}img{max-width:100%;display:block}"
    "figcaption{font-size:14px}.bad{color:#c0392b;font-weight:600}h2{margin-top:1.6em}figure,svg,table{break-inside:avoid}h2{break-after:avoid}@page{size:A4;margin:15mm}"
)


def report(entries: Sequence[Listed], folder: Path, title: str, truth: Mapping[str, str] | None = None) -> str:
    """The page as HTML text; `truth`: what the serials are. Raises RecordError if no part is among the entries."""
    unreadable = [(e.path, e.problem) for e in entries if e.problem is not None]
    records = [e.record for e in entries if e.record is not None and e.record.purpose is Purpose.PART]
    if not records:
        raise RecordError(f"{folder}: no parts among the chosen records; choose others")
    parts = [
        f"<h1>{escape(title)}</h1>",
        _summary(records, sum(e.shown_to_plc is False for e in entries if e.record is not None and e.record.purpose is Purpose.PART)),
        "" if truth is None else _against_truth(records, folder, truth),
        _found(records),
        _trends(records),
        _gallery(records, folder),
        _identity(records),
    ]
    if unreadable:
        rows = "".join(f"<tr><td>{escape(path.name)}</td><td>{escape(str(problem))}</td></tr>" for path, problem in unreadable)
        parts.append(f"<h2 class=bad>Records with problems</h2><table>{rows}</table>")
    return whole(title, parts)


def whole(title: str, parts: Sequence[str]) -> str:
    """The page around its parts."""
    return f"<!doctype html><html lang=en><meta charset=utf-8><title>{escape(title)}</title><style>{STYLE}</style>{''.join(parts)}</html>\n"


def truth_table(found: Errors) -> str:
    """Both kinds of error, with their intervals."""
    rows = "".join(
        f"<tr><th>{name}</th><td>{_share(len(names), of)}</td></tr>"
        for name, names, of in (
            ("escapes (NOK judged OK)", found.escapes, found.nok),
            ("false rejects (OK judged NOK)", found.false_rejects, found.ok),
            ("not judged", found.not_judged, found.ok + found.nok),
        )
    )
    return f"<h2>Against the truth</h2><table>{rows}</table>"


def _share(count: int, of: int) -> str:
    low, high = interval(count, of)
    return f"{count} of {of}, {count / of:.1%} (95 %: {low:.1%} to {high:.1%})" if of else "no such part"


def _against_truth(records: Sequence[Record], folder: Path, truth: Mapping[str, str]) -> str:
    by_serial = {record.serial: record for record in records}  # of a part that was judged twice, the last
    found = errors(truth, {serial: str(record.verdict) for serial, record in by_serial.items()})
    wrong = [("Escapes", found.escapes), ("False rejects", found.false_rejects)]
    return truth_table(found) + "".join(
        f"<h3>{name}</h3>" + "".join(_figure(by_serial[serial], folder) for serial in serials[:GALLERY])
        for name, serials in wrong
        if serials
    )


def _summary(records: Sequence[Record], not_shown: int) -> str:
    counts = Counter(record.verdict for record in records)
    first, last = (f"{records[i].grabbed_at:%Y-%m-%d %H:%M:%S} UTC" for i in (0, -1))
    rows = [
        ("from", first),
        ("to", last),
        ("parts", str(len(records))),
        *((str(v), str(counts[v])) for v in Verdict),
        ("yield", f"{counts[Verdict.OK] / len(records):.1%}"),
        ("not shown to the PLC", str(not_shown)),
    ]
    return "<table>" + "".join(f"<tr><th>{name}</th><td>{value}</td></tr>" for name, value in rows) + "</table>"


def _found(records: Sequence[Record]) -> str:
    reasons = Counter(str(record.inspection.reason) for record in records if record.inspection.reason is not None)
    judged = [[kind is not None for kind in record.inspection.rejected] for record in records if record.inspection.scores]
    if not reasons:
        return "<h2>Findings</h2><p>None.</p>"
    return f"<h2>Findings by kind and angle</h2><div class=row>{bars(list(reasons.items()))}{clock_face(angle_counts(judged))}</div>"


def _trends(records: Sequence[Record]) -> str:
    records = records[:: -(-len(records) // DOTS)]
    bad = [record.verdict is not Verdict.OK for record in records]
    inspections = [record.inspection for record in records]
    limit = records[-1].provenance.thresholds.lowest
    figures = (
        trend([max((s.nok for s in i.scores), default=None) for i in inspections], bad, "worst score of NOK", limit),
        trend([None if i.quality is None else i.quality.mean_dn for i in inspections], bad, "brightness, grey levels"),
        trend([None if i.quality is None else i.quality.sharpness for i in inspections], bad, "sharpness"),
        trend([i.novelty for i in inspections], bad, "distance to the training images"),
    )
    return f"<h2>Part after part</h2><div class=row>{''.join(figures)}</div>"


def _gallery(records: Sequence[Record], folder: Path) -> str:
    nok = [record for record in records if record.verdict is Verdict.NOK]
    if not nok:
        return ""
    shown = nok[-GALLERY:][::-1]
    count = f", the last {len(shown)} of {len(nok)}" if len(shown) < len(nok) else ""
    return f"<h2>NOK parts{count}</h2>" + "".join(_figure(record, folder) for record in shown)


def _figure(record: Record, folder: Path) -> str:
    said = "; ".join(
        f"{f.kind} at {f.start_deg:.0f}°, {f.length_mm:.2f} mm long" + ("" if f.area_mm2 is None else f", {f.area_mm2:.2f} mm²")
        for f in record.inspection.findings
    ) or str(record.verdict)
    caption = f"<b>{record.inspection_id}</b> {escape(record.serial)}, {record.grabbed_at:%Y-%m-%d %H:%M:%S}: {escape(said)}"
    return f"<figure>{_strip(record, folder)}<figcaption>{caption}</figcaption></figure>"


def _strip(record: Record, folder: Path) -> str:
    refused = ((i * SEGMENT_DEG, (i + 1) * SEGMENT_DEG) for i, kind in enumerate(record.inspection.rejected) if kind is not None)
    return strip(None if record.frame_file is None else folder / record.frame_file, record.inspection.ring, refused)


def _identity(records: Sequence[Record]) -> str:
    judges = Counter(record.provenance for record in records)
    head = "<tr><th>parts</th><th>software</th><th>recipe</th><th>model</th><th>SHA-256</th><th>thresholds</th><th>configuration</th></tr>"
    rows = "".join(
        f"<tr><td>{count}</td><td>{escape(p.software)}</td><td>{p.recipe}</td><td>{escape(p.model_version)}</td>"
        f"<td>{escape(p.model_hash[:16])}</td><td>{p.limits}</td>"
        f"<td>{p.config_crc}</td></tr>"
        for p, count in judges.items()
    )
    return f"<h2>Judged by</h2><table>{head}{rows}</table>"
