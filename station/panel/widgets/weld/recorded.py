"""Images, strips and defect maps of recorded parts."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QImage

from station.archive.reader import Row, read_record
from station.channel.preview import make_preview
from station.classify.extent import whole_map
from station.classify.onnx import Classifier
from station.domain import STRIP_COLUMNS, Image, Inspection
from station.errors import ImageError, LocateError
from station.files.image import read_image
from station.panel.session.received import THUMB_PX
from station.panel.widgets.progress import Progress
from station.panel.widgets.weld.previews import drawn_inspection, strip_image
from station.panel.widgets.weld.weld_view import Drawn
from station.records import Record
from station.settings.model import Settings, for_recipe
from station.vision.unwrap import segments, unwrap

NO_IMAGE, DELETED = "the camera sent no image of this part", "the image of this part was deleted"
"""Why there is no frame of a record."""


def recorded_frame(folder: Path, record: Record) -> Image:
    """Return the frame of a record, (H, W) uint8. Raises ImageError saying why there is none."""
    if record.frame_file is None:
        raise ImageError(NO_IMAGE)
    if not (folder / record.frame_file).exists():
        raise ImageError(DELETED)
    return read_image(folder / record.frame_file)


def of_record(folder: Path, record: Record) -> tuple[Drawn, QImage | None]:
    """Return image and strip of a record with what was found in it. Raises ImageError, LocateError."""
    um_per_px = record.provenance.um_per_px
    return judged(recorded_frame(folder, record), record.inspection, um_per_px=um_per_px)


def judged(image: Image, inspection: Inspection, *, um_per_px: float) -> tuple[Drawn, QImage | None]:
    """Return image and strip of a frame, (H, W) uint8, of this scale.

    Raises LocateError if the ring is cut off.
    """
    preview = make_preview(0, image, inspection.ring, um_per_px=um_per_px)
    return drawn_inspection(preview, inspection), strip_image(preview)


def defect_map(settings: Settings, record: Record) -> tuple[int, QImage]:
    """Return the number of a part and its defect map as a layer for the strip, each kind in its colour.

    Raises ImageError, ModelError, SettingsError.
    """
    if record.inspection.ring is None:
        raise ImageError("no weld was found on this part")
    classifier = Classifier(for_recipe(settings, record.provenance.recipe).model.path)
    if classifier.card.file_hash != record.provenance.model_hash:
        raise ImageError("no defect map: another model judged this part")
    frame, um_per_px = recorded_frame(settings.archive.folder, record), record.provenance.um_per_px
    judgement = classifier(segments(unwrap(frame, record.inspection.ring, um_per_px=um_per_px)))
    whole = whole_map(judgement.maps)  # (C, 32, 672)
    layer = np.zeros((*whole.shape[1:], 4), np.uint8)
    for kind, channel in reversed(list(zip(judgement.mapped, whole, strict=True))):
        strong = channel > np.maximum(layer[..., 3] / 200, 0.05)
        layer[strong, :3] = kind.color_rgb[::-1]
        layer[strong, 3] = (channel[strong] * 200).astype(np.uint8)
    height, width = layer.shape[:2]
    image = QImage(layer.data, width, height, width * 4, QImage.Format.Format_ARGB32)
    return record.inspection_id, image.scaledToWidth(STRIP_COLUMNS // 2)


def thumbnails(folder: Path, rows: Sequence[Row], progress: Progress) -> dict[int, QImage]:
    """Return thumbnails of the rows whose frames can be read, by number of the part; fewer if cancelled."""
    found: dict[int, QImage] = {}
    for count, row in enumerate(rows):
        if not progress(count, len(rows)):
            break
        record, _ = read_record(folder, row)
        if record is not None:
            try:
                image = of_record(folder, record)[0].image
            except (ImageError, LocateError):
                continue
            found[row.inspection_id] = image.scaled(THUMB_PX, THUMB_PX, Qt.AspectRatioMode.KeepAspectRatio)
    return found
