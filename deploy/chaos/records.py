"""Kills a writer of records without warning, again and again; proves that whatever the PLC could have seen is in the archive, whole.

A child writes records as the engine does and tells each number once its verdict might be shown; the parent kills it at a random moment.
"""

import argparse
import os
import random
import signal
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from station.archive.reader import find, read_record, verify
from station.archive.writer import Archive
from station.classify.thresholds import Limit, Thresholds
from station.defects import KINDS
from station.domain import SEGMENTS, Frame, Inspection, Origin, Ring, SegmentScores, Verdict
from station.records import Part, Provenance
from station.settings.model import ArchiveSettings

LONGEST_S = 0.08
"""From the first record of a child to its end."""


@dataclass(slots=True)
class Report:
    """What was found after all kills."""

    kills: int = 0
    seen: int = 0
    """Records whose verdict might have been shown."""
    missing: int = 0
    damaged: int = 0
    left_over: int = 0
    """Files of parts that were never listed: nobody saw their verdict."""

    @property
    def good(self) -> bool:
        """Whether nothing was lost and nothing half is listed."""
        return self.missing == self.damaged == 0


def run(folder: Path, kills: int, seed: int) -> Report:
    """Kill `kills` writers one after the other. Needs fork."""
    rng, report, seen = random.Random(seed), Report(kills), set[int]()
    for _ in range(kills):
        seen |= _one(folder, rng.uniform(0, LONGEST_S))
    rows = {row.inspection_id: row for row in find(folder)}
    report.seen, report.missing = len(seen), len(seen - set(rows))
    report.damaged = sum(read_record(folder, row)[1] is not None for row in rows.values())
    for _, problem in verify(folder):
        report.left_over += problem.startswith("is not listed")
        report.damaged += not problem.startswith("is not listed")
    return report


def _one(folder: Path, wait_s: float) -> set[int]:
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        try:
            _write(folder, writer)
        finally:
            os._exit(1)
    os.close(writer)
    first = os.read(reader, 9)
    time.sleep(wait_s)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    told = first
    while more := os.read(reader, 65536):
        told += more
    os.close(reader)
    return {int(line) for line in told.split(b"\n")[:-1]}


def _write(folder: Path, told: int) -> None:
    rng = np.random.default_rng()
    archive = Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1, warn_free_mb=1))
    clean = SegmentScores(1.0, dict.fromkeys(KINDS, 0.0))
    inspection = Inspection(
        Verdict.OK, None, Ring(50, 50, 40, 1), None, (clean,) * SEGMENTS, rejected=(None,) * SEGMENTS
    )
    provenance = Provenance("chaos", "0", "", "", 0, Thresholds(tuple(Limit(kind, 0.5) for kind in KINDS)))
    while True:
        now = datetime.now(UTC)
        frame = Frame(rng.integers(0, 256, (120, 160), dtype=np.uint8), now, "chaos", Origin.SIMULATED)
        record = archive.commit(
            archive.begin(frame), inspection, Part("CHAOS", 1, Origin.SIMULATED), provenance, now
        )
        os.write(told, b"%08d\n" % record.inspection_id)
        archive.mark_shown(record.inspection_id, True)


def main(argv: Sequence[str] | None = None) -> int:
    """Print the report; 0 if nothing was lost."""
    parser = argparse.ArgumentParser(prog="chaos-records", description=__doc__)
    parser.add_argument("--kills", type=int, default=300, help="default: %(default)s")
    parser.add_argument("--seed", type=int, default=1, help="of the moments (default: %(default)s)")
    arguments = parser.parse_args(argv)
    if not hasattr(os, "fork"):
        print("chaos-records: this system cannot fork; run it on Linux", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory(prefix="weldgate-") as folder:
        report = run(Path(folder), arguments.kills, arguments.seed)
    print(
        f"{report.kills} kills, {report.seen} verdicts that might have been seen: {report.missing} missing, "
        f"{report.damaged} damaged; files of unlisted parts left over: {report.left_over}"
    )
    return 0 if report.good else 1


if __name__ == "__main__":
    sys.exit(main())
