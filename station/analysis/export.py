"""Records in the forms of others: CSV, JSON, Parquet, class folders of crops, Q-DAS ASCII."""

import csv
import json
import shutil
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import Any

from station.analysis.decided import defect_kinds
from station.archive.reader import Listed
from station.defects import KINDS, DefectKind, kind_of
from station.domain import SEGMENTS, Inspection
from station.errors import ImageError, LocateError, RecordError
from station.files.durable import replacing
from station.files.image import encode_png, read_image
from station.journal.reviews import Opinion, reviews
from station.records import Record
from station.vision.unwrap import segments, unwrap

OK_FOLDER = "ok"
SEPARATOR, ADDITIONAL = "\x0f", "\x14"
"""Q-DAS ASCII transfer format: between characteristics, and between a value and what belongs to it."""


def export(
    entries: Iterable[Listed], folder: Path, target: Path, form: str, going: Callable[[], bool] = lambda: True
) -> Iterator[tuple[Path, str]]:
    """Write readable records to `target`; yields the others as (file, problem). Raises RecordError, OSError.

    Crops are written while `going`, asked before each part, says so; else what was written is taken away again.
    """
    if target.exists():
        raise RecordError(f"{target}: exists already; name another file or folder")
    good, bad = [], []
    for entry in entries:
        if entry.record is None or (form in ("dataset", "reviewed") and entry.problem is not None):
            bad.append((entry.path, entry.problem or "cannot be read"))
        else:
            good.append(entry)
    if form in ("dataset", "reviewed"):
        try:
            bad += list((_dataset if form == "dataset" else _reviewed)(good, folder, target, going))
        except _Stopped:
            shutil.rmtree(target)
            return
    else:
        with replacing(target) as part:
            {"csv": _csv, "json": _json, "parquet": _parquet, "dfq": _dfq}[form](part, good)
    yield from bad


def flat(entry: Listed) -> dict[str, Any]:
    """One record as one row: numbers and words, the score of NOK of each segment."""
    record = entry.record
    if record is None:
        raise RecordError(f"{entry.path}: {entry.problem}")
    inspection, ring = record.inspection, record.inspection.ring
    worst = max(inspection.findings, key=lambda f: f.score, default=None)
    row: dict[str, Any] = {
        "inspection_id": record.inspection_id,
        "serial": record.serial,
        "trigger_id": record.trigger_id,
        "grabbed_at": record.grabbed_at.isoformat(),
        "purpose": str(record.purpose),
        "origin": str(record.origin),
        "verdict": str(record.verdict),
        "reason": None if inspection.reason is None else str(inspection.reason),
        "shown_to_plc": entry.shown_to_plc,
        "recipe": record.provenance.recipe,
        "model_version": record.provenance.model_version,
        "config_crc": record.provenance.config_crc,
        "center_x_px": None if ring is None else ring.center_x_px,
        "center_y_px": None if ring is None else ring.center_y_px,
        "radius_px": None if ring is None else ring.radius_px,
        "findings": len(inspection.findings),
        "worst_start_deg": None if worst is None else worst.start_deg,
        "worst_length_mm": None if worst is None else worst.length_mm,
        "worst_area_mm2": None if worst is None else worst.area_mm2,
        "novelty": inspection.novelty,
    }
    scores = _scores(inspection)
    return row | {f"p_nok_{i}": score for i, score in enumerate(scores, start=1)}


def _scores(inspection: Inspection) -> list[float | None]:
    return [s.nok for s in inspection.scores] or [None] * SEGMENTS


def _csv(target: Path, entries: list[Listed]) -> None:
    rows = [flat(entry) for entry in entries]
    with target.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]) if rows else ["inspection_id"])
        writer.writeheader()
        writer.writerows(rows)


def _json(target: Path, entries: list[Listed]) -> None:
    rows = [
        flat(e) | {"all_findings": [asdict(f) for f in e.record.inspection.findings] if e.record else []}
        for e in entries
    ]
    target.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


def _parquet(target: Path, entries: list[Listed]) -> None:
    try:
        from pyarrow import Table, parquet
    except ImportError:
        raise RecordError("Parquet needs the package pyarrow: pip install 'weldgate[parquet]'") from None
    parquet.write_table(Table.from_pylist([flat(entry) for entry in entries]), target)


class _Stopped(Exception):
    """Nobody wants it any longer."""


Kinds = dict[int, DefectKind | None]
"""What to call the crops of a part, by the number of the segment; those of other segments are left out."""


def _as_judged(record: Record) -> Kinds:
    return dict(enumerate(defect_kinds(record), start=1))


def _all_ok(record: Record) -> Kinds:
    return dict.fromkeys(range(1, SEGMENTS + 1))


def _reviewed(
    entries: list[Listed], folder: Path, target: Path, going: Callable[[], bool]
) -> Iterator[tuple[Path, str]]:
    """The same of parts that two people agree on.

    Where they say it was a false call, all crops are ok; of a missed defect only the crops in which both see the same kind.
    """
    known = reviews(folder)

    def said(opinion: Opinion) -> list[Listed]:
        return [
            e
            for e in entries
            if e.row.inspection_id in known and known[e.row.inspection_id].agreed is opinion
        ]

    def as_seen(record: Record) -> Kinds:
        return {
            number: kind_of(reason) for number, reason in known[record.inspection_id].agreed_marks.items()
        }

    missed = []
    for entry in said(Opinion.MISSED):
        if known[entry.row.inspection_id].agreed_marks:
            missed.append(entry)
        else:
            yield (
                entry.path,
                "a defect was missed: the two do not see the same kind in any segment, its crops are left out",
            )
    for those, kinds in (
        (said(Opinion.RIGHT), _as_judged),
        (said(Opinion.FALSE_CALL), _all_ok),
        (missed, as_seen),
    ):
        yield from _dataset(those, folder, target, going, kinds)


def _dataset(
    entries: list[Listed],
    folder: Path,
    target: Path,
    going: Callable[[], bool],
    kinds: Callable[[Record], Kinds] = _as_judged,
) -> Iterator[tuple[Path, str]]:
    """A folder each for ok and the kinds of defect: crops by what the station found, for people to correct before training."""
    for name in (OK_FOLDER, *(kind.name for kind in KINDS)):
        (target / name).mkdir(parents=True, exist_ok=True)
    for entry in entries:
        record = entry.record
        if not going():
            raise _Stopped
        if record is None or record.inspection.ring is None or not record.inspection.scores:
            continue  # nothing was judged
        if entry.row.frame_state != "kept":
            yield entry.path, "its picture is no longer kept"
            continue
        try:
            strip = unwrap(read_image(folder / str(record.frame_file)), record.inspection.ring)
        except (ImageError, LocateError) as error:
            yield entry.path, str(error)
            continue
        crops = segments(strip)
        for number, kind in kinds(record).items():
            name = OK_FOLDER if kind is None else kind.name
            (target / name / f"{record.inspection_id:08d}_{number:02d}.png").write_bytes(
                encode_png(crops[number - 1])
            )


def _dfq(target: Path, entries: list[Listed]) -> None:
    """Q-DAS ASCII transfer format: part, 21 characteristics (score of NOK of each segment), one line of values a part."""
    judged = [e for e in entries if e.record is not None and e.record.inspection.scores]
    lines = [f"K0100 {SEGMENTS}", "K1001 weldgate", "K1002 circular laser weld"]
    for i in range(1, SEGMENTS + 1):
        lines += [
            f"K2001/{i} {i}",
            f"K2002/{i} score of NOK, segment {i}",
            f"K2004/{i} 0",
            f"K2022/{i} 4",
            f"K2110/{i} 0",
        ]
        lines += (
            [f"K2111/{i} {judged[0].record.provenance.thresholds.of_segment(i - 1).lowest:g}"]
            if judged and judged[0].record
            else []
        )
    for entry in judged:
        if entry.record is not None:
            when = _qdas_time(entry.record.grabbed_at)
            values = [f"{s.nok:.4f}{ADDITIONAL}0{ADDITIONAL}{when}" for s in entry.record.inspection.scores]
            lines.append(SEPARATOR.join(values))
    target.write_bytes(("\r\n".join(lines) + "\r\n").encode("cp1252", "replace"))


def _qdas_time(when: datetime) -> str:
    return f"{when:%d.%m.%Y/%H:%M:%S}"
