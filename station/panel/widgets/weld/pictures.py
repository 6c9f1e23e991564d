"""Pictures of what was just seen."""

from PySide6.QtGui import QImage

from station.channel.events import PartEvent, Preview
from station.panel.widgets.weld.weld_view import Drawn
from station.records import Record


def drawn(preview: Preview, part: PartEvent | None) -> Drawn:
    """A preview with what was found in it, if that is known."""
    image = QImage.fromData(preview.frame_jpeg)
    if part is None:
        return Drawn(image, preview.scale, preview.origin_px, None, (), ())
    inspection = part.record.inspection
    return Drawn(
        image, preview.scale, preview.origin_px, inspection.ring, inspection.nok, inspection.findings
    )


def strip_image(preview: Preview) -> QImage | None:
    """The strip of a preview."""
    return QImage.fromData(preview.strip_jpeg) if preview.strip_jpeg else None


def nok_scores(record: Record) -> tuple[float, ...]:
    """Score of NOK of each segment."""
    return tuple(s.nok for s in record.inspection.scores)
