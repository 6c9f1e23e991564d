"""Records in the forms of others: CSV, JSON, Parquet, class folders of crops, Q-DAS ASCII."""

import csv
import json
import shutil
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import Any

from station.archive.decided import defect_kinds
from station.archive.reader import Listed
from station.archive.review import Opinion, reviews
from station.domain import SEGMENTS, Inspection, Reason
from station.errors import ImageError, LocateError, RecordError
from station.imagefile import encode_png, read_image
from station.vision.unwrap import segments, unwrap

CLASS_FOLDERS = {None: "ok", Reason.HOLE: "hole", Reason.MISSING_WELD: "missing_weld"}
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
        {"csv": _csv, "json": _json, "parquet": _parquet, "dfq": _dfq}[form](target, good)
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
    rows = [flat(e) | {"all_findings": [asdict(f) for f in e.record.inspection.findings] if e.record else []} for e in entries]
    target.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


def _parquet(target: Path, entries: list[Listed]) -> None:
    try:
        from pyarrow import Table, parquet
    except ImportError:
        raise RecordError("Parquet needs the package pyarrow: pip install 'weldgate[parquet]'") from None
    parquet.write_table(Table.from_pylist([flat(entry) for entry in entries]), target)


class _Stopped(Exception):
    """Nobody wants it any longer."""


def _reviewed(entries: list[Listed], folder: Path, target: Path, going: Callable[[], bool]) -> Iterator[tuple[Path, str]]:
    """The same of parts that two people agree on: where they say it was a false call, all crops are ok."""
    agreed = {number: review.agreed for number, review in reviews(folder).items()}
    for all_ok, opinion in ((False, Opinion.RIGHT), (True, Opinion.FALSE_CALL)):
        yield from _dataset([e for e in entries if agreed.get(e.row.inspection_id) is opinion], folder, target, going, all_ok)
    for entry in entries:
        if agreed.get(entry.row.inspection_id) is Opinion.MISSED:
            yield entry.path, "a defect was missed: nobody said in which segment, its crops are left out"


def _dataset(
    entries: list[Listed], folder: Path, target: Path, going: Callable[[], bool], all_ok: bool = False
) -> Iterator[tuple[Path, str]]:
    """ok, hole, missing_weld: crops by what the station found, for people to correct before anything is trained on them."""
    for name in CLASS_FOLDERS.values():
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
        kinds = [None] * SEGMENTS if all_ok else defect_kinds(record)
        for index, (crop, kind) in enumerate(zip(segments(strip), kinds, strict=True), start=1):
            (target / CLASS_FOLDERS[kind] / f"{record.inspection_id:08d}_{index:02d}.png").write_bytes(encode_png(crop))


def _dfq(target: Path, entries: list[Listed]) -> None:
    """Q-DAS ASCII transfer format: part, 21 characteristics (score of NOK of each segment), one line of values a part."""
    judged = [e for e in entries if e.record is not None and e.record.inspection.scores]
    lines = [f"K0100 {SEGMENTS}", "K1001 weldgate", "K1002 circular laser weld"]
    for i in range(1, SEGMENTS + 1):
        lines += [f"K2001/{i} {i}", f"K2002/{i} score of NOK, segment {i}", f"K2004/{i} 0", f"K2022/{i} 4", f"K2110/{i} 0"]
        lines += [f"K2111/{i} {judged[0].record.provenance.hole_threshold:g}"] if judged and judged[0].record else []
    for entry in judged:
        if entry.record is not None:
            when = _qdas_time(entry.record.grabbed_at)
            values = [f"{s.nok:.4f}{ADDITIONAL}0{ADDITIONAL}{when}" for s in entry.record.inspection.scores]
            lines.append(SEPARATOR.join(values))
    target.write_bytes(("\r\n".join(lines) + "\r\n").encode("cp1252", "replace"))


def _qdas_time(when: datetime) -> str:
    return f"{when:%d.%m.%Y/%H:%M:%S}"
