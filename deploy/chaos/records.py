"""Kills a writer of records at random moments; proves that every verdict that was seen is on disk.

A child process writes records like the engine, and reports each number when its verdict could be shown. The
parent process kills it at a random moment.
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
from station.numbers import whole_option
from station.records import Part, Provenance
from station.settings.model import ArchiveSettings

LONGEST_S = 0.08
"""Maximum time from the first record of a child process to its end."""


@dataclass(slots=True, kw_only=True)
class Report:
    """State of the archive after all kills."""

    kills: int = 0
    seen: int = 0
    """Number of records whose verdict could have been shown."""
    missing: int = 0
    """Number of these records that are not in the index."""
    damaged: int = 0
    """Number of records in the index with a problem."""
    left_over: int = 0
    """Number of files of interrupted parts, whose verdict was never shown."""

    @property
    def good(self) -> bool:
        """True if no record is missing or damaged."""
        return self.missing == self.damaged == 0


def run(folder: Path, kills: int, seed: int) -> Report:
    """Kill `kills` writers one after the other and return the report; works on systems with fork only."""
    rng, report, seen = random.Random(seed), Report(kills=kills), set[int]()
    for _ in range(kills):
        seen |= _one(folder, rng.uniform(0, LONGEST_S))
    rows = {row.inspection_id: row for row in find(folder)}
    report.seen, report.missing = len(seen), len(seen - set(rows))
    report.damaged = sum(read_record(folder, row)[1] is not None for row in rows.values())
    for _, problem in verify(folder):
        report.left_over += problem.startswith("is not in the index")
        report.damaged += not problem.startswith("is not in the index")
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
    reported = first
    while more := os.read(reader, 65536):
        reported += more
    os.close(reader)
    return {int(line) for line in reported.split(b"\n")[:-1]}


def _write(folder: Path, pipe: int) -> None:
    rng = np.random.default_rng()
    archive = Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1, warn_free_mb=1))
    clean = SegmentScores(1.0, dict.fromkeys(KINDS, 0.0))
    inspection = Inspection(
        Verdict.OK,
        None,
        ring=Ring(50, 50, 40, 1),
        quality=None,
        scores=(clean,) * SEGMENTS,
        rejected=(None,) * SEGMENTS,
        unseen=(None,) * SEGMENTS,
    )
    provenance = Provenance(
        software="chaos",
        model_version="0",
        model_hash="",
        ring_model_hash="",
        config_crc=0,
        thresholds=Thresholds(tuple(Limit(kind, 0.5) for kind in KINDS)),
    )
    while True:
        now = datetime.now(UTC)
        frame = Frame(rng.integers(0, 256, (120, 160), dtype=np.uint8), now, "chaos", Origin.SIMULATED)
        record = archive.commit(
            archive.begin(frame), inspection, Part("CHAOS", 1, Origin.SIMULATED), provenance, now=now
        )
        os.write(pipe, b"%08d\n" % record.inspection_id)
        archive.mark_shown(record.inspection_id, True)


def main(argv: Sequence[str] | None = None) -> int:
    """Print the report; return 0 if no record is missing or damaged."""
    parser = argparse.ArgumentParser(
        prog="chaos-records", description="Kill a writer of records at random moments and check the archive."
    )
    parser.add_argument(
        "--kills", type=whole_option, default=300, metavar="N", help="number of kills (default: %(default)s)"
    )
    parser.add_argument(
        "--seed", type=whole_option, default=1, metavar="N", help="seed of the moments (default: %(default)s)"
    )
    arguments = parser.parse_args(argv)
    if not hasattr(os, "fork"):
        print("chaos-records: this system has no fork; run it on Linux", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory(prefix="weldgate-") as folder:
        report = run(Path(folder), arguments.kills, arguments.seed)
    print(
        f"{report.kills} kills, {report.seen} verdicts that could have been seen: {report.missing} missing, "
        f"{report.damaged} damaged; {report.left_over} files of interrupted parts left over"
    )
    return 0 if report.good else 1


if __name__ == "__main__":
    sys.exit(main())
