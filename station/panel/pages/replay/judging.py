"""Judges recorded images again with the settings of one recipe; knows nothing of Qt."""

from dataclasses import dataclass
from pathlib import Path

from station.inspection.inspector import Inspector
from station.inspection.loading import load_inspector
from station.panel.widgets.progress import Progress
from station.records import Provenance
from station.replay.compare import Comparison, compare
from station.replay.files import Source, sources
from station.replay.replayed import Replayed
from station.replay.run import replay
from station.settings.model import Settings, for_scale


@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """A finished replay."""

    sources: tuple[Source, ...]
    results: dict[str, Replayed]
    """Results by name of the image."""
    judge: tuple[Inspector, Provenance]
    """What judged the images."""
    comparison: Comparison | None
    """Comparison with the line, or None if no image was recorded by it."""
    problems: tuple[str, ...]


def judge_images(
    settings: Settings,
    path: Path,
    count: int | None,
    *,
    um_per_px: float,
    progress: Progress,
) -> Done | None:
    """Judge the newest `count` images below a path, or all of them if None, as images of this scale.

    Return None if cancelled. Raises WeldgateError.
    """
    found = sources([path])
    if count is not None:
        found = found[-count:]
    on_one_thread = for_scale(settings, um_per_px).model_copy(
        update={"model": settings.model.model_copy(update={"threads": 1, "reference_path": None})}
    )
    judge = load_inspector(on_one_thread)
    results: dict[str, Replayed] = {}
    problems: list[str] = []
    for replayed in replay(found, on_one_thread, judge=judge, processes=1, part=None):
        results[replayed.name] = replayed
        problems += [*([replayed.problem] if replayed.problem else []), *replayed.warnings]
        if not progress(len(results), len(found)):
            return None
    recorded = any(source.row is not None for source in found)
    comparison = compare(found, results, judge[1]) if recorded else None
    return Done(
        sources=tuple(found),
        results=results,
        judge=judge,
        comparison=comparison,
        problems=tuple(problems),
    )
