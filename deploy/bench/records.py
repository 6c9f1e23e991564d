"""Measures how long it takes to write a record, and to search among 100,000 records."""

import argparse
import statistics
import sys
import tempfile
from collections.abc import Callable, Sequence
from datetime import UTC, datetime, timedelta
from functools import partial
from pathlib import Path
from time import perf_counter

import cv2
import numpy as np
from rich.console import Console
from rich.table import Table

from deploy.demo.station import shipped_parts
from station.archive.reader import Query, find
from station.archive.schema import open_index
from station.archive.writer import Archive
from station.classify.thresholds import Limit, Thresholds
from station.defects import KINDS
from station.domain import SEGMENTS, Frame, Inspection, Origin, Ring, SegmentScores, Verdict
from station.files.image import PNG, encode_png, read_image
from station.records import Part, Provenance
from station.settings.model import ArchiveSettings

RECORDS, TIMES = 100_000, 30
"""Number of records that are searched, and number of repetitions."""
START = datetime(2026, 1, 1, tzinfo=UTC)
"""Time of the first record."""


def main(argv: Sequence[str] | None = None) -> int:
    """Measure, and print medians and maxima."""
    argparse.ArgumentParser(
        prog="bench-records", description="Measure how long it takes to write and search records."
    ).parse_args(argv)
    table = Table("", "median ms", "maximum ms", title=f"records, {TIMES} times each")
    with tempfile.TemporaryDirectory(prefix="weldgate-") as name:
        folder = Path(name)
        for what, work in (*_writing(folder / "written"), *_searching(folder / "searched")):
            taken = []
            for _ in range(TIMES):
                start = perf_counter()
                work()
                taken.append((perf_counter() - start) * 1000)
            table.add_row(what, f"{statistics.median(taken):.1f}", f"{max(taken):.1f}")
    Console(width=110).print(table)
    _codecs(Console(width=110))
    return 0


def _codecs(console: Console) -> None:
    """Compare lossless codecs, in turns on one thread."""
    images = [read_image(part.path) for part in shipped_parts()]
    level1, none = (cv2.IMWRITE_PNG_COMPRESSION, 1), (cv2.IMWRITE_TIFF_COMPRESSION, 1)
    codecs: dict[str, tuple[str, tuple[int, ...]]] = {
        "PNG, as in the archive": (".png", PNG),
        "PNG, level 1": (".png", level1),
        "PNG, level 1, filter SUB": (".png", (*level1, cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_SUB)),
        "TIFF, LZW": (".tiff", (cv2.IMWRITE_TIFF_COMPRESSION, 5)),
        "TIFF, uncompressed": (".tiff", none),
    }
    taken: dict[str, list[float]] = {name: [] for name in codecs}
    sizes = dict.fromkeys(codecs, 0)
    for image in images:
        for name, (suffix, options) in codecs.items():
            start = perf_counter()
            _, buffer = cv2.imencode(suffix, image, options)
            taken[name].append((perf_counter() - start) * 1000)
            sizes[name] += len(buffer)
    table = Table(
        "",
        "median ms",
        "MB per frame",
        title=f"lossless codecs, {len(images)} frames of {images[0].shape[1]} x {images[0].shape[0]}",
    )
    for name, ms in taken.items():
        table.add_row(name, f"{statistics.median(ms):.1f}", f"{sizes[name] / len(images) / 1e6:.2f}")
    console.print(table)


def _writing(folder: Path) -> list[tuple[str, Callable[[], object]]]:
    image = read_image(shipped_parts()[0].path)
    archive = Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1, warn_free_mb=1))
    scores = (SegmentScores(1.0, dict.fromkeys(KINDS, 0.0)),) * SEGMENTS
    inspection = Inspection(
        Verdict.OK,
        None,
        ring=Ring(50, 50, 40, 1),
        quality=None,
        scores=scores,
        rejected=(None,) * SEGMENTS,
        unseen=(None,) * SEGMENTS,
        look=(0.123,) * 192,
    )
    provenance = Provenance(
        software="bench",
        model_version="0",
        model_hash="",
        ring_model_hash="",
        config_crc=0,
        thresholds=Thresholds(tuple(Limit(kind, 0.5) for kind in KINDS)),
    )

    def commit(frame: Frame | None) -> None:
        archive.commit(
            archive.begin(frame),
            inspection,
            Part("BENCH", 1, Origin.SIMULATED),
            provenance,
            now=datetime.now(UTC),
        )

    frame = Frame(image, datetime.now(UTC), "bench", Origin.SIMULATED)
    return [
        (
            f"encode a frame of {image.shape[1]} x {image.shape[0]}, in parallel with the inspection",
            lambda: encode_png(image),
        ),
        ("encode, files, fsync, row", lambda: commit(frame)),
        ("record without a frame: file, fsync, row", lambda: commit(None)),
    ]


def _searching(folder: Path) -> list[tuple[str, Callable[[], object]]]:
    folder.mkdir()
    index, rng = open_index(folder), np.random.default_rng(0)
    worst = rng.beta(0.3, 6, RECORDS)
    rows, segments = [], []
    for i in range(RECORDS):
        when = (START + timedelta(seconds=20 * i)).isoformat()
        verdict = "NOK" if worst[i] > 0.5 else "OK"
        name = f"2026-01-01/{i + 1:08d}"
        rows.append((f"CELL-{i:07d}", i % 65535 + 1, when, verdict, float(worst[i]), name))
        if worst[i] >= 0.05:
            segments.append((i + 1, int(rng.integers(1, SEGMENTS + 1)), float(worst[i])))
    with index:
        index.executemany(
            "INSERT INTO records (serial, trigger_id, grabbed_at, origin, verdict, worst_score, record_file, "
            "record_sha256) VALUES (?, ?, ?, 'camera', ?, ?, ?, '')",
            rows,
        )
        index.executemany("INSERT INTO segments VALUES (?, ?, ?)", segments)
    index.close()
    day = START + timedelta(days=10)
    queries = (
        ("one serial", Query(serial="CELL-0077777")),
        ("a prefix of serials, 1000 parts", Query(serial="CELL-0077*")),
        ("an hour", Query(since=day, until=day + timedelta(hours=1))),
        ("score of segment 7 at least 0.8", Query(segment=7, min_score=0.8)),
        ("the last 300", Query(newest_first=True, limit=300)),
        ("the last 100 NOK", Query(verdict="NOK", newest_first=True, limit=100)),
    )
    return [
        (f"find {name}: {len(find(folder, query))} of {RECORDS}", partial(find, folder, query))
        for name, query in queries
    ]


if __name__ == "__main__":
    sys.exit(main())
