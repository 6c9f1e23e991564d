"""Report of a replay: counts, images of flipped verdicts, and errors if the truth is known."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from station.analysis.report.page import Rows, truth_rows
from station.analysis.report.strip import Gallery, Weld, strip
from station.analysis.report.template import render
from station.analysis.truth import Errors, errors
from station.domain import Ring, Verdict
from station.files.durable import write_whole
from station.records import Provenance
from station.replay.compare import Comparison
from station.replay.files import Source
from station.replay.replayed import Replayed

SHOWN = 40
"""Maximum number of welds in one gallery."""
FLIPS = (
    (Verdict.NOK, Verdict.OK, "NOK on the line, OK now: would be released"),
    (Verdict.OK, Verdict.NOK, "OK on the line, NOK now"),
)
"""Flips that have a gallery: verdict before, verdict now, title."""
TEMPLATE = Path(__file__).with_name("report.html.j2")
"""Template of the report."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AgainstLine:
    """Comparison of the verdicts of the replay with those of the line."""

    compared: int
    """Number of parts that were compared."""
    flipped: int
    """Number of verdicts that flip."""
    flips: tuple[Gallery, ...]
    errors: tuple[str, ...]
    """One line for each flip from or to ERROR."""
    not_alike: tuple[str, ...]
    """Names of the records that are not reproducible."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayPage:
    """Content of report.html.j2."""

    title: str
    summary: Rows
    line: AgainstLine | None
    """Comparison with the line; None if no image comes from an archive."""
    truth: Rows | None
    """Errors against the truth; None if the truth is not known."""
    wrong: tuple[Gallery, ...]
    problems: tuple[str, ...]


def write_page(
    folder: Path,
    *,
    sources: Sequence[Source],
    results: Mapping[str, Replayed],
    judge: Provenance,
    comparison: Comparison | None,
    truth: Mapping[str, str] | None,
    problems: Sequence[str],
) -> Path:
    """Write `folder`/report.html and return its path. Raises OSError."""
    images = {source.name: source.path for source in sources}
    welds = _Welds(images, results, judge.um_per_px)
    verdicts = Counter(replayed.verdict for replayed in results.values())
    found = None if truth is None else _errors(truth, results)
    page = ReplayPage(
        title="weldgate: replay",
        summary=(
            ("images", str(len(results))),
            *((str(verdict), str(verdicts[verdict])) for verdict in Verdict),
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


def _errors(truth: Mapping[str, str], results: Mapping[str, Replayed]) -> Errors:
    """Return the errors against a truth that names files with or without folder and suffix."""
    names = {key: name for name in results for key in (Path(name).stem, Path(name).name, name)}
    return errors(
        {names[key]: true for key, true in truth.items() if key in names},
        {name: str(replayed.verdict) for name, replayed in results.items()},
    )


def _against_line(comparison: Comparison, welds: "_Welds") -> AgainstLine:
    names: dict[tuple[Verdict, Verdict], list[str]] = {}
    for flip in comparison.flips:
        names.setdefault((flip.before, flip.now), []).append(flip.name)
    to_error = [flip for flip in comparison.flips if Verdict.ERROR in (flip.before, flip.now)]
    return AgainstLine(
        compared=comparison.compared,
        flipped=len(comparison.flips),
        flips=welds.galleries(*((title, names.get((before, now), [])) for before, now, title in FLIPS)),
        errors=tuple(f"{flip.name}: {flip.before} to {flip.now}" for flip in to_error),
        not_alike=tuple(comparison.not_alike),
    )


def _wrong(found: Errors, welds: "_Welds") -> tuple[Gallery, ...]:
    return welds.galleries(("Escapes", found.escapes), ("False rejects", found.false_rejects))


@dataclass(frozen=True, slots=True)
class _Welds:
    images: Mapping[str, Path]
    results: Mapping[str, Replayed]
    um_per_px: float

    def galleries(self, *titled: tuple[str, Sequence[str]]) -> tuple[Gallery, ...]:
        """Return a gallery for each title that has names."""
        return tuple(self._gallery(title, names) for title, names in titled if names)

    def _gallery(self, title: str, names: Sequence[str]) -> Gallery:
        more = f", the first {SHOWN} of {len(names)}" if len(names) > SHOWN else f": {len(names)}"
        return Gallery(title + more, tuple(self._weld(name) for name in names[:SHOWN]))

    def _weld(self, name: str) -> Weld:
        replayed = self.results[name]
        circle, worst = replayed.circle, replayed.worst
        ring = None if circle is None else Ring(circle.center_x_px, circle.center_y_px, circle.radius_px, 1.0)
        lines = (
            f"{finding.kind} at {finding.start_deg:.0f}°, {finding.length_mm:.2f} mm long"
            for finding in replayed.findings
        )
        score = "" if worst is None else f"highest score {worst:.3f}"
        texts = (replayed.reason or "", replayed.detail or "", score, "; ".join(lines))
        result = ", ".join(text for text in texts if text)
        spans = ((finding.start_deg, finding.end_deg) for finding in replayed.findings)
        image = strip(self.images[name], ring, spans, um_per_px=self.um_per_px)
        return Weld(name, f"{replayed.verdict}: {result}", image)
