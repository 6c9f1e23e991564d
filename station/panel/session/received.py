"""Keeps what the window has received from the engine, for all pages to read; only the channel changes it."""

import time
from collections import deque
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QImage

from station.channel.events import SETUP_IMAGE, STATUS_LOST_S, PartEvent, Preview, StatusEvent
from station.domain import Purpose, Verdict
from station.errors import WeldgateError
from station.panel.session.bridge import Bridge
from station.settings.file import load
from station.settings.model import Settings

FILM = 300
"""Number of the newest parts that are kept."""
THUMB_PX = 96
"""Longer side of a thumbnail."""


@dataclass(frozen=True, slots=True)
class Pinned:
    """A part that stays on the page, and its image once that has come."""

    part: PartEvent
    preview: Preview | None


class Received(QObject):
    """The window's memory: pages can be built from it at any time; its signals say what is new."""

    status_changed = Signal()
    part_came = Signal()
    preview_came = Signal()
    setup_image_came = Signal(object)
    """Carries a SetupImageEvent: the numbers of a setup image."""
    settings_changed = Signal()
    """Emitted when the settings file or its adjustments were changed."""

    def __init__(self, bridge: Bridge, settings: Settings, path: Path) -> None:
        """Keep what `bridge` emits; `settings` were read from the file `path`."""
        super().__init__()
        self._settings, self._path = settings, path
        self._status: StatusEvent | None = None
        self._parts: deque[PartEvent] = deque(maxlen=FILM)
        self._thumbs: dict[int, QImage] = {}
        self._preview: Preview | None = None
        self._setup_preview: Preview | None = None
        self._last_nok: Pinned | None = None
        bridge.status.connect(self._on_status)
        bridge.parts.connect(self._on_parts)
        bridge.preview.connect(self._on_preview)
        bridge.setup_image.connect(self.setup_image_came)

    @property
    def settings(self) -> Settings:
        """Settings as they were last read from the file."""
        return self._settings

    @property
    def folder(self) -> Path:
        """Folder of the archive."""
        return self._settings.archive.folder

    @property
    def status(self) -> StatusEvent | None:
        """Newest status of the engine, however old it is."""
        return self._status

    @property
    def engine_there(self) -> bool:
        """True if the newest status is not too old."""
        return self._status is not None and time.monotonic() - self._status.at_s <= STATUS_LOST_S

    @property
    def parts(self) -> Sequence[PartEvent]:
        """Newest parts, at most `FILM`, the newest last."""
        return self._parts

    @property
    def last(self) -> PartEvent | None:
        """Newest part."""
        return self._parts[-1] if self._parts else None

    @property
    def last_nok(self) -> Pinned | None:
        """Newest part that was judged NOK."""
        return self._last_nok

    @property
    def thumbs(self) -> Mapping[int, QImage]:
        """Thumbnails of the newest parts by number of the part."""
        return self._thumbs

    @property
    def preview(self) -> Preview | None:
        """Image of the newest part that has one."""
        return self._preview

    @property
    def setup_preview(self) -> Preview | None:
        """Newest setup image."""
        return self._setup_preview

    def _on_status(self, event: StatusEvent) -> None:
        before, self._status = self._status, event
        if before is not None and event.config_crc != before.config_crc:
            self.read_settings()
        self.status_changed.emit()

    def read_settings(self) -> None:
        """Read the settings file again, after it was changed at this window or another one."""
        with suppress(WeldgateError):  # the engine reports what is wrong with them
            settings = load(self._path)
            if settings != self._settings:
                self._settings = settings
                self.settings_changed.emit()

    def _on_parts(self, events: Sequence[PartEvent]) -> None:
        for event in events:
            if len(self._parts) == FILM:
                self._thumbs.pop(self._parts[0].record.inspection_id, None)
            self._parts.append(event)
            if event.record.verdict is Verdict.NOK and event.record.purpose is Purpose.PART:
                self._last_nok = Pinned(event, self._preview if shows(self._preview, event) else None)
        self.part_came.emit()

    def _on_preview(self, preview: Preview) -> None:
        if preview.inspection_id == SETUP_IMAGE:
            self._setup_preview = preview
            self.preview_came.emit()
            return
        self._preview = preview
        pinned = self._last_nok
        if pinned is not None and shows(preview, pinned.part):
            self._last_nok = Pinned(pinned.part, preview)
        last = self.last
        if last is not None and shows(preview, last):
            image = QImage.fromData(preview.frame_jpeg)
            if not image.isNull():
                mode = Qt.TransformationMode.SmoothTransformation
                self._thumbs[preview.inspection_id] = image.scaled(
                    THUMB_PX, THUMB_PX, Qt.AspectRatioMode.KeepAspectRatio, mode
                )
        self.preview_came.emit()


def shows(preview: Preview | None, part: PartEvent) -> bool:
    """Return whether an image is of that part; a part that could not be recorded has number 0."""
    return preview is not None and preview.inspection_id == part.record.inspection_id > 0
