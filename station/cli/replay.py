"""`weldgate replay`: judges recorded images again, prints a summary and writes files on request."""

import argparse
import os
import sys
from collections import Counter
from pathlib import Path

from rich.progress import track

from station.analysis.truth import read_truth
from station.domain import Verdict
from station.errors import SettingsError
from station.files.destination import Destination, find_destination
from station.inspection.loading import load_inspector
from station.replay.compare import compare
from station.replay.files import sources
from station.replay.replayed import Replayed
from station.replay.report import write_page
from station.replay.results import write_csv, write_json
from station.replay.run import replay
from station.settings.file import load
from station.settings.model import Settings, for_images, for_recipe, for_scale


def run_replay(arguments: argparse.Namespace, shipped: Path) -> int:
    """Run the command and return its exit code. Raises WeldgateError.

    The code is 0, or 1 if an image could not be inspected or a record is judged differently by the networks
    and limits that made it.
    """
    images = sources(arguments.paths)
    settings = _settings(arguments, shipped)
    processes = os.cpu_count() or 1 if arguments.processes is None else arguments.processes
    if not 1 <= processes <= 256:
        raise SettingsError(f"the number of processes must be 1 to 256: --processes {processes}")
    truth = None if arguments.truth is None else read_truth(arguments.truth)
    outputs = [_writable(target) for target in (arguments.json, arguments.csv) if target is not None]
    if len(outputs) == 2 and outputs[0] == outputs[1]:
        raise SettingsError(f"--json and --csv name the same output: {arguments.csv}. Name another one")
    part = None
    if arguments.json is not None and outputs[0].is_replaceable:
        part = outputs[0].path.with_name(outputs[0].path.name + ".part")
    judge = load_inspector(settings)
    judged = replay(images, settings, judge=judge, processes=processes, part=part)
    silent = not sys.stderr.isatty()
    unordered, problems, bad = dict[str, Replayed](), list[str](), 0
    for replayed in track(judged, description="replay", total=len(images), disable=silent, transient=True):
        unordered[replayed.name] = replayed
        bad += replayed.problem is not None
        for line in (*([replayed.problem] if replayed.problem else []), *replayed.warnings):
            problems.append(line)
            print(f"weldgate: {line}", file=sys.stderr)
    results = {source.name: unordered[source.name] for source in images}
    if arguments.json is not None:
        write_json(arguments.json, results.values())
    if part is not None:
        part.unlink(missing_ok=True)
    if arguments.csv is not None:
        write_csv(arguments.csv, results.values())
    verdicts = Counter(replayed.verdict for replayed in results.values())
    print(f"{len(images)} images: {', '.join(f'{verdicts[verdict]} {verdict}' for verdict in Verdict)}")
    recorded = any(source.row is not None for source in images)
    comparison = compare(images, results, judge[1]) if recorded else None
    if comparison is not None:
        print("\n".join(comparison.lines()))
        for name in comparison.not_alike:
            line = (
                f"{name}: not reproducible: same networks and limits give a different result than on the line"
            )
            print(f"weldgate: {line}", file=sys.stderr)
        for problem in comparison.problems:
            print(f"weldgate: {problem}", file=sys.stderr)
        bad += len(comparison.not_alike) + len(comparison.problems)
        problems += comparison.problems
    if arguments.report is not None:
        page = write_page(
            arguments.report,
            sources=images,
            results=results,
            judge=judge[1],
            comparison=comparison,
            truth=truth,
            problems=problems,
        )
        print(page)
    return 1 if bad else 0


def _writable(target: Path) -> Destination:
    """Return where an output goes. Raises SettingsError if it cannot be written."""
    try:
        destination = find_destination(target)
        destination.check()
    except OSError:
        raise SettingsError(
            f"results cannot be written: {target}. Name a file in a writable folder"
        ) from None
    return destination


def _settings(arguments: argparse.Namespace, shipped: Path) -> Settings:
    settings = for_recipe(
        for_images(shipped) if arguments.settings is None else load(arguments.settings), arguments.recipe
    )
    if arguments.um_per_px is not None:
        settings = for_scale(settings, arguments.um_per_px)
    if arguments.model is None:
        return settings
    return settings.model_copy(
        update={"model": settings.model.model_copy(update={"path": arguments.model, "reference_path": None})}
    )
