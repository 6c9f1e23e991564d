"""Pictures of kept records."""

from collections.abc import Callable, Sequence
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
from station.panel.widgets.weld.pictures import strip_image
from station.panel.widgets.weld.weld_view import Drawn
from station.records import Record
from station.settings.model import Settings, for_recipe
from station.vision.unwrap import segments, unwrap


def kept_frame(folder: Path, record: Record) -> Image:
    """The frame of a record (H, W) uint8. Raises ImageError saying why there is none."""
    if record.frame_file is None:
        raise ImageError("no picture came")
    if not (folder / record.frame_file).exists():
        raise ImageError("its picture is no longer kept")
    return read_image(folder / record.frame_file)


def of_record(folder: Path, record: Record) -> tuple[Drawn, QImage | None]:
    """Picture and strip of a record, as it was judged. Raises ImageError."""
    return judged(kept_frame(folder, record), record.inspection)


def judged(image: Image, inspection: Inspection) -> tuple[Drawn, QImage | None]:
    """Return picture and strip of an image (H, W) uint8. Raises LocateError if the ring is not wholly in view."""
    preview = make_preview(0, image, inspection.ring)
    small = QImage.fromData(preview.frame_jpeg)
    return Drawn(
        small, preview.scale, preview.origin_px, inspection.ring, inspection.nok, inspection.findings
    ), strip_image(preview)


def defect_map(settings: Settings, record: Record) -> tuple[int, QImage]:
    """Return the number of the part, and where the network sees each kind of defect in its colour, to lay over the strip.

    Raises ImageError, ModelError, SettingsError.
    """
    if record.inspection.ring is None:
        raise ImageError("no weld was found in it")
    classifier = Classifier(for_recipe(settings, record.provenance.recipe).model.path)
    if classifier.card.file_hash != record.provenance.model_hash:
        raise ImageError("another model judged it: where that saw defects is not known")
    found = classifier(segments(unwrap(kept_frame(settings.archive.folder, record), record.inspection.ring)))
    whole = whole_map(found.maps)  # (C, 32, 672)
    layer = np.zeros((*whole.shape[1:], 4), np.uint8)
    for kind, channel in reversed(list(zip(found.mapped, whole, strict=True))):
        rgb = kind.color_rgb
        strong = channel > np.maximum(layer[..., 3] / 200, 0.05)
        layer[strong, :3] = rgb[::-1]
        layer[strong, 3] = (channel[strong] * 200).astype(np.uint8)
    height, width = layer.shape[:2]
    image = QImage(layer.data, width, height, width * 4, QImage.Format.Format_ARGB32)
    return record.inspection_id, image.scaledToWidth(STRIP_COLUMNS // 2)


def small_pictures(
    folder: Path, rows: Sequence[Row], keep_going: Callable[[int, int], bool]
) -> dict[int, QImage]:
    """Return small images of the rows whose frames can be read, by number of the part.

    `keep_going` is called with how many of how many are done; the rest is left out once it returns False.
    """
    found: dict[int, QImage] = {}
    for count, row in enumerate(rows):
        if not keep_going(count, len(rows)):
            break
        record, _ = read_record(folder, row)
        if record is not None:
            try:
                image = of_record(folder, record)[0].image
            except (ImageError, LocateError):
                continue
            found[row.inspection_id] = image.scaled(THUMB_PX, THUMB_PX, Qt.AspectRatioMode.KeepAspectRatio)
    return found
