"""What a replay brought, as a page: counts, verdicts that flip with their pictures, errors where the truth is known."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from station.analysis.report.page import Rows, truth_rows
from station.analysis.report.strip import Gallery, Weld, strip
from station.analysis.report.template import render
from station.analysis.truth import Errors, errors
from station.domain import Ring
from station.files.durable import write_whole
from station.records import Provenance
from station.replay.compare import Comparison
from station.replay.files import Source

SHOWN = 40
"""Pictures of each kind."""
FLIPS = (
    ("NOK", "OK", "NOK on the line, OK now: would be released"),
    ("OK", "NOK", "OK on the line, NOK now"),
)
TEMPLATE = Path(__file__).with_name("report.html.j2")


@dataclass(frozen=True, slots=True)
class AgainstLine:
    """Verdicts of the replay next to those of the line."""

    compared: int
    flipped: int
    flips: tuple[Gallery, ...]
    errors: tuple[str, ...]
    """Flips from or to ERROR, one line each."""
    not_alike: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayPage:
    """What report.html.j2 lays out; rows are pairs of a name and a text."""

    title: str
    summary: Rows
    line: AgainstLine | None
    """None: no record was among the images."""
    truth: Rows | None
    """None: the truth is not known."""
    wrong: tuple[Gallery, ...]
    problems: tuple[str, ...]


def write_page(
    folder: Path,
    sources: Sequence[Source],
    entries: Mapping[str, dict[str, Any]],
    judge: Provenance,
    comparison: Comparison | None,
    truth: Mapping[str, str] | None,
    problems: Sequence[str],
) -> Path:
    """Write `folder`/report.html and return its path. Raises OSError."""
    welds = _Welds({source.name: source.path for source in sources}, entries)
    verdicts = Counter(entry["verdict"] for entry in entries.values())
    found = None if truth is None else _errors(truth, entries)
    page = ReplayPage(
        title="weldgate: replay",
        summary=(
            ("images", str(len(entries))),
            *((v, str(verdicts[v])) for v in ("OK", "NOK", "ERROR")),
            ("model", judge.model_version),
            ("thresholds", judge.limits),
            ("recipe", str(judge.recipe)),
        ),
        line=None if comparison is None else _against_line(comparison, welds),
        truth=None if found is None else truth_rows(found),
        wrong=() if found is None else _wrong(found, welds),
        problems=tuple(problems),
    )
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "report.html"
    write_whole(path, render(TEMPLATE, page).encode())
    return path


def _errors(truth: Mapping[str, str], entries: Mapping[str, dict[str, Any]]) -> Errors:
    """A truth may name files with or without their folder and ending."""
    names = {key: name for name in entries for key in (Path(name).stem, Path(name).name, name)}
    return errors(
        {names[key]: true for key, true in truth.items() if key in names},
        {name: e["verdict"] for name, e in entries.items()},
    )


def _against_line(comparison: Comparison, welds: "_Welds") -> AgainstLine:
    flips = [(title, [f.name for f in comparison.flips if (f.before, f.now) == (before, now)]) for before, now, title in FLIPS]
    return AgainstLine(
        comparison.compared,
        len(comparison.flips),
        welds.galleries(*flips),
        tuple(f"{f.name}: {f.before} to {f.now}" for f in comparison.flips if "ERROR" in (f.before, f.now)),
        tuple(comparison.not_alike),
    )


def _wrong(found: Errors, welds: "_Welds") -> tuple[Gallery, ...]:
    return welds.galleries(("Escapes", found.escapes), ("False rejects", found.false_rejects))


@dataclass(frozen=True, slots=True)
class _Welds:
    pictures: Mapping[str, Path]
    entries: Mapping[str, dict[str, Any]]

    def galleries(self, *titled: tuple[str, Sequence[str]]) -> tuple[Gallery, ...]:
        """A gallery for each title that has names."""
        return tuple(self._gallery(title, names) for title, names in titled if names)

    def _gallery(self, title: str, names: Sequence[str]) -> Gallery:
        more = f", the first {SHOWN} of {len(names)}" if len(names) > SHOWN else f": {len(names)}"
        return Gallery(title + more, tuple(self._weld(name) for name in names[:SHOWN]))

    def _weld(self, name: str) -> Weld:
        entry = self.entries[name]
        center, worst = (
            entry.get("center"),
            max((s for s in entry["segments"] if s is not None), default=None),
        )
        ring = None if center is None else Ring(center[0], center[1], entry["radius"], 1.0)
        found = "; ".join(f"{f['kind']} at {f['start_deg']:.0f}°, {f['length_mm']:.2f} mm long" for f in entry["findings"])
        score = "" if worst is None else f"worst score {worst:.3f}"
        said = ", ".join(text for text in (entry["reason"] or "", score, found) if text)
        spans = ((f["start_deg"], f["end_deg"]) for f in entry["findings"])
        return Weld(name, f"{entry['verdict']}: {said}", strip(self.pictures[name], ring, spans))
