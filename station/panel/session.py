"""What the window has heard of the engine and who is logged in; pages may be built anew from it at any time."""

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QObject, Qt, QTimer, Signal
from PySide6.QtGui import QImage

from station.domain import Verdict
from station.errors import RecordError, WeldgateError
from station.events import LookEvent, PartEvent, Preview, StatusEvent
from station.panel.bridge import Bridge
from station.plc.alarms import Alarm
from station.requests import Reload, Request, Service, TestPicture
from station.settings import Settings
from station.users import Level, User, log_out

FILM = 300
"""Parts at hand."""
THUMB_PX = 96
STATUS_LOST_S = 2.0
RENEW_MS = 1000
PATIENCE_S = 30.0
"""So long an engine may take to load changed settings."""


@dataclass(frozen=True, slots=True)
class Heard:
    """A part, when it came, and its picture in small."""

    event: PartEvent
    at_s: float
    """Monotonic time."""


class Session(QObject):
    """The window's memory; every signal says what is new."""

    status_changed = Signal()
    part_came = Signal()
    preview_came = Signal()
    look_came = Signal(object)
    """LookEvent"""
    user_changed = Signal()
    service_changed = Signal()
    change_refused = Signal()
    """Changed settings could not be used and were taken back."""

    def __init__(self, bridge: Bridge, settings: Settings, path: Path) -> None:
        """`path`: of the settings file."""
        super().__init__()
        self.bridge, self.settings, self.path = bridge, settings, path
        self.status: StatusEvent | None = None
        self._status_s = -1e9
        self.parts: deque[Heard] = deque(maxlen=FILM)
        self.thumbs: dict[int, QImage] = {}
        self.preview: Preview | None = None
        self.look_preview: Preview | None = None
        """Of the last setting-up picture."""
        self.last_nok: tuple[PartEvent, Preview] | None = None
        self.user: User | None = None
        self._undo: tuple[Callable[[], None], float] | None = None
        """Takes the last change back, and until when it is waited for."""
        self.service: Service | None = None
        """What is asked for while somebody works on the station."""
        bridge.status.connect(self._on_status)
        bridge.part.connect(self._on_part)
        bridge.preview.connect(self._on_preview)
        bridge.look.connect(self._on_look)
        self._renew = QTimer(self)
        self._renew.timeout.connect(self._say_service)
        self._idle = QTimer(self)
        self._idle.setSingleShot(True)
        self._idle.timeout.connect(lambda: self.log_out("idle"))

    @property
    def folder(self) -> Path:
        """The archive."""
        return self.settings.archive.folder

    @property
    def status_age_s(self) -> float:
        """Since the engine was heard last."""
        return time.monotonic() - self._status_s

    @property
    def engine_there(self) -> bool:
        """Whether the engine was heard just now."""
        return self.status is not None and self.status_age_s <= STATUS_LOST_S

    @property
    def last(self) -> Heard | None:
        """The newest part."""
        return self.parts[-1] if self.parts else None

    def may(self, level: Level) -> bool:
        """Whether who is logged in may do what this level may."""
        return self.user is not None and self.user.level >= level

    def ask(self, request: Request) -> bool:
        """False if no engine is there."""
        return self.bridge.ask(request)

    def test_picture(self, master: str = "") -> bool:
        """False if no engine is there."""
        return self.ask(TestPicture(time.time(), master))

    def reload(self, undo: Callable[[], None]) -> bool:
        """False if no engine is there. `undo` is done if the engine refuses the settings."""
        refused = self.status is not None and Alarm.SETTINGS_REFUSED in self.status.alarms
        self._undo = None if refused else (undo, time.monotonic() + PATIENCE_S)
        return self.ask(Reload(time.time()))

    def _look_at_change(self, event: StatusEvent) -> None:
        if self._undo is None:
            return
        undo, until_s = self._undo
        if Alarm.SETTINGS_REFUSED in event.alarms:
            self._undo = None
            try:
                undo()
            except WeldgateError:
                return  # the alarm stays, and with it the reason in the engine's log
            self.ask(Reload(time.time()))
            self.change_refused.emit()
        elif time.monotonic() > until_s:
            self._undo = None

    def log_in(self, user: User) -> None:
        """They stay so until they log out or nothing is touched for a while."""
        self.user = user
        self.touched()
        self.user_changed.emit()

    def log_out(self, why: str) -> None:
        """Ends service mode too."""
        self.end_service()
        user, self.user = self.user, None
        self._idle.stop()
        if user is not None:
            try:
                log_out(self.folder, user, why)
            except RecordError:
                pass  # whoever leaves must be able to
            self.user_changed.emit()

    def touched(self) -> None:
        """Somebody is there."""
        if self.user is not None:
            self._idle.start(int(self.settings.panel.logout_min * 60_000))

    def serve(self, service: Service) -> None:
        """Begin or go on with service mode; renewed until `end_service`."""
        self.service = service
        self._say_service()
        self._renew.start(RENEW_MS)
        self.service_changed.emit()

    def end_service(self) -> None:
        """The station goes on."""
        if self.service is None:
            return
        self._renew.stop()
        self.ask(Service(time.time(), self.service.who, over=True))
        self.service = None
        self.service_changed.emit()

    def _say_service(self) -> None:
        if self.service is not None:
            s = self.service
            self.ask(Service(time.time(), s.who, s.bit, s.look, s.exposure_us, s.gain_db))

    def _on_status(self, event: StatusEvent) -> None:
        self.status, self._status_s = event, time.monotonic()
        self._look_at_change(event)
        self.status_changed.emit()

    def _on_part(self, event: PartEvent) -> None:
        if len(self.parts) == FILM:
            self.thumbs.pop(self.parts[0].event.record.inspection_id, None)
        self.parts.append(Heard(event, time.monotonic()))
        self.part_came.emit()

    def _on_preview(self, preview: Preview) -> None:
        if preview.inspection_id == 0:
            self.look_preview = preview
            self.preview_came.emit()
            return
        self.preview = preview
        last = self.last
        if last is not None and preview.inspection_id == last.event.record.inspection_id:
            image = QImage.fromData(preview.frame_jpeg)
            if not image.isNull():
                mode = Qt.TransformationMode.SmoothTransformation
                self.thumbs[preview.inspection_id] = image.scaled(THUMB_PX, THUMB_PX, Qt.AspectRatioMode.KeepAspectRatio, mode)
            if last.event.record.verdict is Verdict.NOK:
                self.last_nok = (last.event, preview)
        self.preview_came.emit()

    def _on_look(self, event: LookEvent) -> None:
        self.look_came.emit(event)

    def close(self) -> None:
        """Stop the timers and the channel."""
        self.log_out("window closed")
        self._renew.stop()
        self._idle.stop()
        self.bridge.close()
