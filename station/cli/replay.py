"""`weldgate replay`: what it says and writes."""

import argparse
import os
import sys
from pathlib import Path
from typing import Any

from rich.progress import track

from station.analysis.truth import read_truth
from station.errors import SettingsError
from station.inspection.loading import load_inspector
from station.replay.compare import compare
from station.replay.files import sources
from station.replay.report import write_page
from station.replay.results import write_csv, write_json
from station.replay.run import replay
from station.settings.file import load
from station.settings.model import Settings, for_images, for_recipe


def run_replay(arguments: argparse.Namespace, shipped: Path) -> int:
    """0 good, 1 if a file could not be read or a record is not judged as it was by the same judge. Raises WeldgateError."""
    found = sources(arguments.paths)
    settings = _settings(arguments, shipped)
    um_per_px = settings.weld.um_per_px if arguments.um_per_px is None else arguments.um_per_px
    if not 1 <= um_per_px <= 200:
        raise SettingsError(f"--um-per-px is {um_per_px}; 1 to 200 is allowed")
    processes = os.cpu_count() or 1 if arguments.processes is None else arguments.processes
    if not 1 <= processes <= 256:
        raise SettingsError(f"--processes is {processes}; 1 to 256 is allowed")
    truth = None if arguments.truth is None else read_truth(arguments.truth)
    for target in (arguments.json, arguments.csv):
        if target is not None and (target.is_dir() or not os.access(target.resolve().parent, os.W_OK)):
            raise SettingsError(f"{target}: cannot be written there; name a file in a writable folder")
    part = None if arguments.json is None else arguments.json.with_name(arguments.json.name + ".part")
    outcomes, problems, bad, judge = {}, [], 0, load_inspector(settings)
    judged = replay(found, settings, judge, um_per_px / settings.weld.um_per_px, processes, part)
    for outcome in track(judged, description="replay", total=len(found), disable=not sys.stderr.isatty(), transient=True):
        outcomes[outcome.name] = outcome.entry
        bad += outcome.problem is not None
        for said in (*([outcome.problem] if outcome.problem else []), *outcome.warnings):
            problems.append(said)
            print(f"weldgate: {said}", file=sys.stderr)
    entries: dict[str, dict[str, Any]] = {source.name: outcomes[source.name] for source in found}
    if arguments.json is not None:
        write_json(arguments.json, entries)
    if part is not None:
        part.unlink(missing_ok=True)
    if arguments.csv is not None:
        write_csv(arguments.csv, entries)
    verdicts = [e["verdict"] for e in entries.values()]
    print(f"{len(found)} images: {verdicts.count('OK')} OK, {verdicts.count('NOK')} NOK, {verdicts.count('ERROR')} ERROR")
    comparison = compare(found, entries, judge[1]) if any(source.row is not None for source in found) else None
    if comparison is not None:
        print("\n".join(comparison.lines()))
        for name in comparison.not_alike:
            print(f"weldgate: {name}: the same networks and limits judge it otherwise than on the line", file=sys.stderr)
        for problem in comparison.problems:
            print(f"weldgate: {problem}", file=sys.stderr)
        bad += len(comparison.not_alike) + len(comparison.problems)
        problems += comparison.problems
    if arguments.report is not None:
        print(write_page(arguments.report, found, entries, judge[1], comparison, truth, problems))
    return 1 if bad else 0


def _settings(arguments: argparse.Namespace, shipped: Path) -> Settings:
    settings = for_recipe(for_images(shipped) if arguments.settings is None else load(arguments.settings), arguments.recipe)
    if arguments.model is None:
        return settings
    return settings.model_copy(update={"model": settings.model.model_copy(update={"path": arguments.model, "reference_path": None})})
