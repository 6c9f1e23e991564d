"""The results as files: JSON with everything, CSV with one row a file."""

import csv
import io
import json
from pathlib import Path
from typing import Any

from station.files.durable import write_whole


def write_json(path: Path, entries: dict[str, dict[str, Any]]) -> None:
    """Raises OSError."""
    _write(path, json.dumps(entries, indent=1))


def write_csv(path: Path, entries: dict[str, dict[str, Any]]) -> None:
    """Name, verdict, reason, ring, worst score. Raises OSError."""
    table = io.StringIO(newline="")
    writer = csv.writer(table)
    writer.writerow(("file", "verdict", "reason", "center_x_px", "center_y_px", "radius_px", "worst_p_nok"))
    for name, item in entries.items():
        x, y = item.get("center") or (None, None)
        scores = [s for s in item["segments"] if s is not None]
        writer.writerow((name, item["verdict"], item["reason"], x, y, item.get("radius"), max(scores, default=None)))
    _write(path, table.getvalue())


def _write(path: Path, text: str) -> None:
    """Write the whole file or nothing; characters of file names that UTF-8 cannot hold are escaped."""
    write_whole(path, text.encode("utf-8", "backslashreplace"))
