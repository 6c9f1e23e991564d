"""What the window has heard of the engine; read by all pages, written by nobody but the engine's messages."""

import time
from collections import deque
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QImage

from station.channel.events import SETTING_UP, STATUS_LOST_S, LookEvent, PartEvent, Preview, StatusEvent
from station.domain import Purpose, Verdict
from station.errors import WeldgateError
from station.panel.session.bridge import Bridge
from station.settings.file import load
from station.settings.model import Settings

FILM = 300
"""Parts at hand."""
THUMB_PX = 96


@dataclass(frozen=True, slots=True)
class Pinned:
    """A part that stays in sight, and its picture once it has come."""

    part: PartEvent
    preview: Preview | None


class Received(QObject):
    """The window's memory; every signal says what is new. Pages may be made again from it at any time."""

    status_changed = Signal()
    part_came = Signal()
    preview_came = Signal()
    look_came = Signal(object)
    """LookEvent"""
    settings_changed = Signal()
    """Somebody has changed the settings file, or its adjustments."""

    def __init__(self, bridge: Bridge, settings: Settings, path: Path) -> None:
        """`path`: of the settings file."""
        super().__init__()
        self._settings, self._path = settings, path
        self._status: StatusEvent | None = None
        self._parts: deque[PartEvent] = deque(maxlen=FILM)
        self._thumbs: dict[int, QImage] = {}
        self._preview: Preview | None = None
        self._look_preview: Preview | None = None
        self._last_nok: Pinned | None = None
        bridge.status.connect(self._on_status)
        bridge.parts.connect(self._on_parts)
        bridge.preview.connect(self._on_preview)
        bridge.look.connect(self._on_look)

    @property
    def settings(self) -> Settings:
        """Settings as the file last said them."""
        return self._settings

    @property
    def folder(self) -> Path:
        """The archive."""
        return self._settings.archive.folder

    @property
    def status(self) -> StatusEvent | None:
        """The engine's newest status, however old it is."""
        return self._status

    @property
    def engine_there(self) -> bool:
        """True if the engine was heard just now."""
        return self._status is not None and time.monotonic() - self._status.at_s <= STATUS_LOST_S

    @property
    def parts(self) -> Sequence[PartEvent]:
        """The last parts, the newest last."""
        return self._parts

    @property
    def last(self) -> PartEvent | None:
        """The newest part."""
        return self._parts[-1] if self._parts else None

    @property
    def last_nok(self) -> Pinned | None:
        """The newest part that was judged NOK."""
        return self._last_nok

    @property
    def thumbs(self) -> Mapping[int, QImage]:
        """Small pictures of the last parts, by their numbers."""
        return self._thumbs

    @property
    def preview(self) -> Preview | None:
        """Picture of the newest part that had one."""
        return self._preview

    @property
    def look_preview(self) -> Preview | None:
        """Picture of the last setup image."""
        return self._look_preview

    def _on_status(self, event: StatusEvent) -> None:
        before, self._status = self._status, event
        if before is not None and event.config_crc != before.config_crc:
            self.read_settings()
        self.status_changed.emit()

    def read_settings(self) -> None:
        """Read the settings file again: it was changed at this window or another one."""
        with suppress(WeldgateError):  # the engine has said what is wrong with them
            found = load(self._path)
            if found != self._settings:
                self._settings = found
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
        if preview.inspection_id == SETTING_UP:
            self._look_preview = preview
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

    def _on_look(self, event: LookEvent) -> None:
        self.look_came.emit(event)


def shows(preview: Preview | None, part: PartEvent) -> bool:
    """Whether a picture is of that part; parts that could not be recorded have no number of their own."""
    return preview is not None and preview.inspection_id == part.record.inspection_id > 0
