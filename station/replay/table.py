"""The results as CSV: one row a file."""

import csv
from pathlib import Path
from typing import Any


def write_csv(path: Path, entries: dict[str, dict[str, Any]]) -> None:
    """Name, verdict, reason, ring, worst score. Raises OSError."""
    part = path.with_name(path.name + ".new")
    with part.open("w", newline="", encoding="utf-8", errors="backslashreplace") as file:
        writer = csv.writer(file)
        writer.writerow(("file", "verdict", "reason", "center_x_px", "center_y_px", "radius_px", "worst_p_nok"))
        for name, item in entries.items():
            x, y = item.get("center") or (None, None)
            scores = [s for s in item["segments"] if s is not None]
            writer.writerow((name, item["verdict"], item["reason"], x, y, item.get("radius"), max(scores, default=None)))
    part.replace(path)
