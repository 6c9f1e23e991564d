"""What a replay brought, as a page: counts, verdicts that flip with their pictures, errors where the truth is known."""

from collections import Counter
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from station.domain import Ring
from station.records import Provenance
from station.replay.compare import Comparison
from station.replay.files import Source
from station.report.page import truth_table, whole
from station.report.strip import strip
from station.report.truth import Errors, errors

SHOWN = 40
"""Pictures of each kind."""
FLIPS = (("NOK", "OK", "NOK on the line, OK now: would be released"), ("OK", "NOK", "OK on the line, NOK now"))


def write_page(
    folder: Path,
    sources: Sequence[Source],
    entries: Mapping[str, dict[str, Any]],
    judge: Provenance,
    comparison: Comparison | None,
    truth: Mapping[str, str] | None,
    problems: Sequence[str],
) -> Path:
    """`folder`/report.html; the file. Raises OSError."""
    pictures = {source.name: source.path for source in sources}
    verdicts = Counter(entry["verdict"] for entry in entries.values())
    rows = [("images", len(entries)), *((v, verdicts[v]) for v in ("OK", "NOK", "ERROR")), ("model", judge.model_version)]
    rows += [("thresholds", judge.limits), ("recipe", judge.recipe)]
    parts = ["<h1>weldgate: replay</h1>", _table(rows)]
    if comparison is not None:
        parts.append(f"<h2>Against the line</h2><p>{comparison.compared} parts compared, {len(comparison.flips)} verdicts flip.</p>")
        for before, now, title in FLIPS:
            names = [f.name for f in comparison.flips if (f.before, f.now) == (before, now)]
            parts.append(_figures(title, names, pictures, entries))
        other = [f"{f.name}: {f.before} to {f.now}" for f in comparison.flips if "ERROR" in (f.before, f.now)]
        parts.append(_list("Flips from or to ERROR", other))
        parts.append(_list("Judged otherwise by the same judge", comparison.not_alike))
    if truth is not None:
        found = _errors(truth, entries)
        parts.append(truth_table(found))
        parts.append(
            _figures("Escapes", found.escapes, pictures, entries) + _figures("False rejects", found.false_rejects, pictures, entries)
        )
    parts.append(_list("Files with problems", problems))
    folder.mkdir(parents=True, exist_ok=True)
    page = folder / "report.html"
    page.write_text(whole("weldgate: replay", parts), encoding="utf-8", errors="backslashreplace")
    return page


def _errors(truth: Mapping[str, str], entries: Mapping[str, dict[str, Any]]) -> Errors:
    """A truth may name files with or without their folder and ending."""
    names = {key: name for name in entries for key in (Path(name).stem, Path(name).name, name)}
    return errors({names[key]: true for key, true in truth.items() if key in names}, {name: e["verdict"] for name, e in entries.items()})


def _table(rows: Sequence[tuple[str, object]]) -> str:
    return "<table>" + "".join(f"<tr><th>{name}</th><td>{escape(str(value))}</td></tr>" for name, value in rows) + "</table>"


def _list(title: str, lines: Sequence[str]) -> str:
    if not lines:
        return ""
    return f"<h2>{title}</h2><ul>{''.join(f'<li>{escape(line)}</li>' for line in lines)}</ul>"


def _figures(title: str, names: Sequence[str], pictures: Mapping[str, Path], entries: Mapping[str, dict[str, Any]]) -> str:
    if not names:
        return ""
    more = f", the first {SHOWN} of {len(names)}" if len(names) > SHOWN else f": {len(names)}"
    return f"<h2>{title}{more}</h2>" + "".join(_figure(name, pictures[name], entries[name]) for name in names[:SHOWN])


def _figure(name: str, picture: Path, entry: dict[str, Any]) -> str:
    center, worst = entry.get("center"), max((s for s in entry["segments"] if s is not None), default=None)
    ring = None if center is None else Ring(center[0], center[1], entry["radius"], 1.0)
    found = "; ".join(f"{f['kind']} at {f['start_deg']:.0f}°, {f['length_mm']:.2f} mm long" for f in entry["findings"])
    said = ", ".join(text for text in (entry["reason"] or "", "" if worst is None else f"worst score {worst:.3f}", found) if text)
    spans = ((f["start_deg"], f["end_deg"]) for f in entry["findings"])
    return (
        f"<figure>{strip(picture, ring, spans)}<figcaption><b>{escape(name)}</b> {entry['verdict']}: {escape(said)}</figcaption></figure>"
    )
