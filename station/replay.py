"""Judge recorded images again with the line's own code."""

import csv
import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from station.domain import Inspection
from station.errors import ImageError
from station.imagefile import SUFFIXES, read_image
from station.inspection import Inspector


def image_files(paths: Iterable[Path]) -> list[Path]:
    """Image files among `paths`; folders are searched all the way down, in the order of names.

    Raises ImageError if a path does not exist or no image is found.
    """
    found: list[Path] = []
    for path in paths:
        if path.is_dir():
            found += sorted(p for p in path.rglob("*") if p.suffix.lower() in SUFFIXES and p.is_file())
        elif path.is_file():
            found.append(path)
        else:
            raise ImageError(f"{path}: no such file or folder")
    if not found:
        raise ImageError(f"{', '.join(str(p) for p in paths)}: no images found; PNG, BMP, TIFF and JPEG are read")
    return found


def judge(inspector: Inspector, path: Path) -> tuple[dict[str, Any], str | None]:
    """One file's entry for the report, and what was wrong with the file, if anything."""
    try:
        image = read_image(path)
    except ImageError as error:
        return {"verdict": "ERROR", "reason": str(error), "segments": [None] * 21, "findings": []}, str(error)
    return entry(inspector.inspect(image)), None


def entry(inspection: Inspection) -> dict[str, Any]:
    """An inspection in the replay format: pixels of the input image, angle 0 at +x, clockwise as seen."""
    ring, timing = inspection.ring, inspection.timing
    steps = (timing.locate_ms, timing.unwrap_ms, timing.classify_ms)
    return {
        "center": None if ring is None else [ring.center_x_px, ring.center_y_px],
        "radius": None if ring is None else ring.radius_px,
        "verdict": str(inspection.verdict),
        "reason": None if inspection.reason is None else str(inspection.reason),
        "segments": [s.nok for s in inspection.scores] or [None] * 21,
        "unwrap_start_deg": 0.0,
        "direction": "cw",
        "findings": [{**asdict(f), "kind": str(f.kind)} for f in inspection.findings],
        "novelty": inspection.novelty,
        "inspection_ms": sum(ms for ms in steps if ms is not None),
    }


def write_json(path: Path, entries: dict[str, dict[str, Any]]) -> None:
    """The whole report, or nothing."""
    part = path.with_name(path.name + ".part")
    part.write_text(json.dumps(entries, indent=1))
    part.replace(path)


def write_csv(path: Path, entries: dict[str, dict[str, Any]]) -> None:
    """One row a file: name, verdict, reason, ring, worst score."""
    part = path.with_name(path.name + ".part")
    with part.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("file", "verdict", "reason", "center_x_px", "center_y_px", "radius_px", "worst_p_nok"))
        for name, item in entries.items():
            x, y = item.get("center") or (None, None)
            scores = [s for s in item["segments"] if s is not None]
            writer.writerow((name, item["verdict"], item["reason"], x, y, item.get("radius"), max(scores, default=None)))
    part.replace(path)
