"""Exports records as CSV, JSON, Parquet, Q-DAS ASCII, or as folders of crops by class."""

import csv
import json
import shutil
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import Any

from station.analysis.decided import defect_kinds
from station.analysis.worst_segment import WORST, worst_segment
from station.archive.reader import Listed
from station.defects import KINDS, DefectKind, kind_of
from station.domain import SEGMENTS
from station.errors import ImageError, LocateError, RecordError
from station.files.destination import find_destination
from station.files.durable import replacing
from station.files.image import encode_png, read_image
from station.journal.reviews import Opinion, reviews
from station.records import Record
from station.vision.unwrap import segments, unwrap

OK_FOLDER = "ok"
"""Folder of the crops without a defect."""
SEPARATOR, ADDITIONAL = "\x0f", "\x14"
"""Separators of the Q-DAS ASCII transfer format: between characteristics, and between a value and its
additions."""
VALID, INVALID = 0, 255
"""Attributes of a value in the Q-DAS ASCII transfer format."""


def export(
    entries: Iterable[Listed],
    folder: Path,
    target: Path,
    form: str,
    *,
    keep_going: Callable[[], bool] = lambda: True,
) -> Iterator[tuple[Path, str]]:
    """Write the readable records to `target`, and yield (file, problem) for the others.

    `form` is one of `station.analysis.forms.FORMATS`. An export of crops calls `keep_going` before each part;
    if it returns False, everything that was written is deleted. Raises RecordError, OSError.
    """
    destination = find_destination(target)
    if form in ("dataset", "reviewed") and destination.descriptor is not None:
        raise RecordError(f"{target}: crops are written into a folder; name one")
    if destination.status is not None and (destination.is_kept or form in ("dataset", "reviewed")):
        raise RecordError(f"{target}: already exists; name another file or folder")
    good, bad = [], []
    for entry in entries:
        if entry.record is None or (form in ("dataset", "reviewed") and entry.problem is not None):
            bad.append((entry.path, entry.problem or "cannot be read"))
        else:
            good.append(entry)
    if form in ("dataset", "reviewed"):
        try:
            bad += list((_dataset if form == "dataset" else _reviewed)(good, folder, target, keep_going))
        except _Cancelled:
            shutil.rmtree(target)
            return
    else:
        with replacing(target) as part:
            {"csv": _csv, "json": _json, "parquet": _parquet, "dfq": _dfq}[form](part, good)
    yield from bad


def flat(entry: Listed) -> dict[str, Any]:
    """Return one record as one row of a table, with the score of NOK of each segment."""
    record = entry.record
    if record is None:
        raise RecordError(f"{entry.path}: {entry.problem}")
    inspection, ring = record.inspection, record.inspection.ring
    worst = max(inspection.findings, key=lambda finding: finding.score, default=None)
    row: dict[str, Any] = {
        "inspection_id": record.inspection_id,
        "serial": record.serial,
        "trigger_id": record.trigger_id,
        "grabbed_at": record.grabbed_at.isoformat(),
        "purpose": str(record.purpose),
        "origin": str(record.origin),
        "verdict": str(record.verdict),
        "reason": None if inspection.reason is None else str(inspection.reason),
        "detail": inspection.detail,
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
    quality = worst_segment(inspection)
    row |= {f"worst_{name}": None if quality is None else getattr(quality, name) for name in WORST}
    scores = inspection.nok_scores or (None,) * SEGMENTS
    return row | {f"p_nok_{i}": score for i, score in enumerate(scores, start=1)}


def _csv(target: Path, entries: list[Listed]) -> None:
    rows = [flat(entry) for entry in entries]
    with target.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]) if rows else ["inspection_id"])
        writer.writeheader()
        writer.writerows(rows)


def _json(target: Path, entries: list[Listed]) -> None:
    rows = [
        flat(entry)
        | {"all_findings": [asdict(own) for own in entry.record.inspection.findings] if entry.record else []}
        for entry in entries
    ]
    target.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


def _parquet(target: Path, entries: list[Listed]) -> None:
    try:
        from pyarrow import Table, parquet
    except ImportError:
        raise RecordError(
            "Parquet needs the package pyarrow; install it with pip install 'weldgate[parquet]'"
        ) from None
    parquet.write_table(Table.from_pylist([flat(entry) for entry in entries]), target)


class _Cancelled(Exception):
    """The export was cancelled."""


Kinds = dict[int, DefectKind | None]
"""Kind of defect of the crops of a part by segment number; crops of other segments are not exported."""


def _as_judged(record: Record) -> Kinds:
    kinds = defect_kinds(record)
    known = enumerate(record.inspection.invalid, start=1)
    return {number: kinds[number - 1] for number, says_nothing in known if not says_nothing}


def _all_ok(record: Record) -> Kinds:
    return dict.fromkeys(_seen(record))


def _seen(record: Record) -> list[int]:
    """Return the numbers of the segments that were seen: a cover must not be learned as a good weld."""
    return [number for number, cause in enumerate(record.inspection.unseen, start=1) if cause is None]


def _reviewed(
    entries: list[Listed], folder: Path, target: Path, keep_going: Callable[[], bool]
) -> Iterator[tuple[Path, str]]:
    """Write the crops of the parts on which two people agree, like `_dataset`.

    If the verdict was a false call, all crops are ok. If a defect was missed, only the crops in which both
    people see the same kind of defect are written.
    """
    known = reviews(folder)

    def agreed_on(opinion: Opinion) -> list[Listed]:
        return [
            entry
            for entry in entries
            if entry.row.inspection_id in known and known[entry.row.inspection_id].agreed is opinion
        ]

    def as_seen(record: Record) -> Kinds:
        return {
            number: kind_of(reason) for number, reason in known[record.inspection_id].agreed_marks.items()
        }

    missed = []
    for entry in agreed_on(Opinion.MISSED):
        if known[entry.row.inspection_id].agreed_marks:
            missed.append(entry)
        else:
            yield (
                entry.path,
                "not exported: a defect was missed, but the two reviews name no segment with the same kind",
            )
    for chosen, kinds in (
        (agreed_on(Opinion.RIGHT), _as_judged),
        (agreed_on(Opinion.FALSE_CALL), _all_ok),
        (missed, as_seen),
    ):
        yield from _dataset(chosen, folder, target, keep_going, kinds=kinds)


def _dataset(
    entries: list[Listed],
    folder: Path,
    target: Path,
    keep_going: Callable[[], bool],
    *,
    kinds: Callable[[Record], Kinds] = _as_judged,
) -> Iterator[tuple[Path, str]]:
    """Write the crops of judged parts into one folder per class: ok, and each kind of defect.

    By default the class is what the station found; people correct it before training.
    """
    for name in (OK_FOLDER, *(kind.name for kind in KINDS)):
        (target / name).mkdir(parents=True, exist_ok=True)
    for entry in entries:
        record = entry.record
        if not keep_going():
            raise _Cancelled
        if record is None or record.inspection.ring is None or not record.inspection.scores:
            continue  # nothing was judged
        if entry.row.frame_state != "kept":
            yield entry.path, "its frame was deleted"
            continue
        try:
            frame, um_per_px = read_image(folder / str(record.frame_file)), record.provenance.um_per_px
            strip = unwrap(frame, record.inspection.ring, um_per_px=um_per_px)
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
    """Write Q-DAS ASCII: part, 21 characteristics (scores of NOK), one line of values per part."""
    judged = [entry for entry in entries if entry.record is not None and entry.record.inspection.scores]
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
            values = [
                f"{own or 0.0:.4f}{ADDITIONAL}{VALID if own is not None else INVALID}{ADDITIONAL}{when}"
                for own in entry.record.inspection.nok_scores
            ]
            lines.append(SEPARATOR.join(values))
    target.write_bytes(("\r\n".join(lines) + "\r\n").encode("cp1252", "replace"))


def _qdas_time(when: datetime) -> str:
    return f"{when:%d.%m.%Y/%H:%M:%S}"
