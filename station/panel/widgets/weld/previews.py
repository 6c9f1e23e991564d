"""Images of the parts that were just inspected."""

from dataclasses import replace

from PySide6.QtGui import QImage

from station.channel.events import PartEvent, Preview
from station.domain import Inspection, Ring
from station.panel.widgets.weld.weld_view import Drawn


def drawn(preview: Preview, ring: Ring | None = None) -> Drawn:
    """Return a preview, with a ring if one is given."""
    image = QImage.fromData(preview.frame_jpeg)
    return Drawn(
        image=image,
        scale=preview.scale,
        origin_px=preview.origin_px,
        um_per_px=preview.um_per_px,
        ring=ring,
    )


def drawn_part(preview: Preview, part: PartEvent) -> Drawn:
    """Return the preview of a part with what was found in it."""
    return drawn_inspection(preview, part.record.inspection)


def drawn_inspection(preview: Preview, inspection: Inspection) -> Drawn:
    """Return a preview with ring, rejected segments and findings of an inspection."""
    plain = drawn(preview, inspection.ring)
    return replace(
        plain,
        segments_nok=inspection.nok,
        segments_invalid=inspection.invalid,
        findings=inspection.findings,
    )


def strip_image(preview: Preview) -> QImage | None:
    """Return the strip of a preview, or None if no ring was found."""
    return QImage.fromData(preview.strip_jpeg) if preview.strip_jpeg else None
