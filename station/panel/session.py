"""What the window has heard of the engine and who is logged in; pages may be built anew from it at any time."""

import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QObject, Qt, QTimer, Signal
from PySide6.QtGui import QImage

from station.accounts import log_out
from station.archive.journal import Kind
from station.archive.journal_writer import append
from station.domain import Purpose, Verdict
from station.errors import LoginError, RecordError, WeldgateError
from station.events import SETTING_UP, STATUS_LOST_S, LookEvent, PartEvent, Preview, StatusEvent
from station.panel.bridge import Bridge
from station.plc.alarms import Alarm
from station.plc.registers import Offline, Status
from station.requests import Reload, Request, ResetCounts, Service, TestPicture
from station.settings import Settings
from station.settings_file import load
from station.users import Level, User

FILM = 300
"""Parts at hand."""
THUMB_PX = 96
RENEW_MS = 1000
AGAIN_S = 1.0
"""An engine that did not take up changed settings is asked again."""


@dataclass(slots=True)
class Change:
    """Changed settings that the engine has not yet answered for."""

    undo: Callable[[], None] | None
    """None: it was taken back, and that is what the engine is to take up."""
    asked_s: float
    """Epoch seconds."""
    again_s: float


@dataclass(frozen=True, slots=True)
class Pinned:
    """A part that stays in sight, and its picture once it has come."""

    part: PartEvent
    preview: Preview | None


class Session(QObject):
    """The window's memory; every signal says what is new."""

    status_changed = Signal()
    part_came = Signal()
    preview_came = Signal()
    look_came = Signal(object)
    """LookEvent"""
    part_wanted = Signal(int)
    """Somebody wants to look at this part of the history."""
    user_changed = Signal()
    service_changed = Signal()
    settings_changed = Signal()
    """Somebody has changed the settings file, or its adjustments."""
    change_used = Signal()
    """The station goes by the changed settings."""
    change_refused = Signal()
    """Changed settings could not be used and were taken back."""

    def __init__(self, bridge: Bridge, settings: Settings, path: Path) -> None:
        """`path`: of the settings file."""
        super().__init__()
        self.bridge, self.settings, self.path = bridge, settings, path
        self.status: StatusEvent | None = None
        self.parts: deque[PartEvent] = deque(maxlen=FILM)
        self.thumbs: dict[int, QImage] = {}
        self.preview: Preview | None = None
        self.look_preview: Preview | None = None
        """Of the last setting-up picture."""
        self.last_nok: Pinned | None = None
        self.user: User | None = None
        self.change: Change | None = None
        self.service: Service | None = None
        """What is asked for while somebody works on the station."""
        bridge.status.connect(self._on_status)
        bridge.parts.connect(self._on_parts)
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
    def engine_there(self) -> bool:
        """Whether the engine was heard just now."""
        return self.status is not None and time.monotonic() - self.status.at_s <= STATUS_LOST_S

    @property
    def last(self) -> PartEvent | None:
        """The newest part."""
        return self.parts[-1] if self.parts else None

    def may(self, level: Level) -> bool:
        """Whether who is logged in may do what this level may."""
        return self.user is not None and self.user.level >= level

    def ask(self, request: Request) -> bool:
        """False if no engine is there."""
        return self.bridge.ask(request)

    def who(self, level: Level) -> User:
        """Who is logged in. Raises LoginError if they may not do what this level may."""
        if self.user is None or self.user.level < level:
            raise LoginError(f"a login of the level {level.name.lower()} is needed")
        return self.user

    def test_picture(self, master: str = "") -> bool:
        """False if no engine is there. Raises LoginError, RecordError if it cannot be noted who asked."""
        user = self.who(Level.SETTER if master else Level.OPERATOR)
        append(self.folder, Kind.SERVICE, user.name, "test picture", after=master)
        return self.ask(TestPicture(time.time(), master))

    def reset_counts(self) -> bool:
        """False if no engine is there. Raises LoginError, RecordError if it cannot be noted who asked."""
        user, counts = self.who(Level.SETTER), None if self.status is None else self.status.line.counts
        before = "" if counts is None else f"OK {counts.ok}, NOK {counts.nok}, ERROR {counts.error}"
        append(self.folder, Kind.SERVICE, user.name, "counters", before, "0")
        return self.ask(ResetCounts(time.time(), user.name))

    def reload(self, undo: Callable[[], None]) -> bool:
        """False if no engine is there. `undo` is done if the engine refuses the settings."""
        before = self.change
        if before is None or before.undo is None:
            return self._ask_to_reload(undo)
        first = before.undo  # not yet taken up: both are refused or used

        def both() -> None:
            undo()
            first()

        return self._ask_to_reload(both)

    def _ask_to_reload(self, undo: Callable[[], None] | None) -> bool:
        now_s = time.time()
        self.change = Change(undo, now_s, now_s + AGAIN_S)
        return self.ask(Reload(now_s))

    def _look_at_change(self, event: StatusEvent) -> None:
        """A change is in use once the engine says that it has read the settings since."""
        if (change := self.change) is None:
            return
        if event.reloaded_s >= change.asked_s:
            if change.undo is None or Alarm.SETTINGS_REFUSED not in event.alarms:
                self.change = None
                if change.undo is not None:
                    self.change_used.emit()
                return
            try:
                change.undo()
            except WeldgateError:
                return  # perhaps another window writes: again with the next status
            self._ask_to_reload(None)
            self.change_refused.emit()
        elif time.time() >= change.again_s and event.line.offline is not Offline.ATTENDED:
            change.again_s = time.time() + AGAIN_S
            self.ask(Reload(time.time()))

    def log_in(self, user: User) -> None:
        """They stay so until they log out, another one logs in, or nothing is touched for a while."""
        if self.user is not None:
            self.log_out("another one logs in")
        self.user = user
        self.touched()
        self.user_changed.emit()

    def log_out(self, why: str) -> None:
        """Ends service mode too."""
        self.end_service()
        user, self.user = self.user, None
        self._idle.stop()
        if user is not None:
            with suppress(RecordError):  # whoever leaves must be able to
                log_out(self.folder, user, why)
            self.user_changed.emit()

    def touched(self) -> None:
        """Somebody is there."""
        if self.user is not None:
            self._idle.start(int(self.settings.panel.logout_min * 60_000))

    def serve(self, service: Service) -> None:
        """Begin or go on with service mode; renewed until `end_service`. Raises LoginError, RecordError; then nothing is asked for."""
        user, before = self.who(Level.SETTER), self.service
        if before is None:
            append(self.folder, Kind.SERVICE, user.name, "service mode", after="begins")
        if service.bit != (before.bit if before is not None else 0):
            append(self.folder, Kind.SERVICE, user.name, "bit by hand", _bit(before.bit if before is not None else 0), _bit(service.bit))
        self.service = service
        self._say_service()
        self._renew.start(RENEW_MS)
        self.service_changed.emit()

    def end_service(self) -> None:
        """The station goes on."""
        if self.service is None:
            return
        self._renew.stop()
        who, self.service = self.service.who, None
        self.ask(Service(time.time(), who, over=True))
        with suppress(RecordError):  # whoever leaves must be able to
            append(self.folder, Kind.SERVICE, who, "service mode", "begins", "over")
        self.service_changed.emit()

    def _say_service(self) -> None:
        if self.service is not None:
            s = self.service
            self.ask(Service(time.time(), s.who, s.bit, s.look, s.exposure_us, s.gain_db))

    def _on_status(self, event: StatusEvent) -> None:
        before, self.status = self.status, event
        if before is not None and event.config_crc != before.config_crc:
            self._read_settings()
        self._look_at_change(event)
        self.status_changed.emit()

    def _read_settings(self) -> None:
        """The station goes by other settings: perhaps another window has changed them."""
        with suppress(WeldgateError):  # the engine has said what is wrong with them
            found = load(self.path)
            if found != self.settings:
                self.settings = found
                self.settings_changed.emit()

    def _on_parts(self, events: Sequence[PartEvent]) -> None:
        for event in events:
            if len(self.parts) == FILM:
                self.thumbs.pop(self.parts[0].record.inspection_id, None)
            self.parts.append(event)
            if event.record.verdict is Verdict.NOK and event.record.purpose is Purpose.PART:
                self.last_nok = Pinned(event, self.preview if shows(self.preview, event) else None)
        self.part_came.emit()

    def _on_preview(self, preview: Preview) -> None:
        if preview.inspection_id == SETTING_UP:
            self.look_preview = preview
            self.preview_came.emit()
            return
        self.preview = preview
        pinned = self.last_nok
        if pinned is not None and shows(preview, pinned.part):
            self.last_nok = Pinned(pinned.part, preview)
        last = self.last
        if last is not None and shows(preview, last):
            image = QImage.fromData(preview.frame_jpeg)
            if not image.isNull():
                mode = Qt.TransformationMode.SmoothTransformation
                self.thumbs[preview.inspection_id] = image.scaled(THUMB_PX, THUMB_PX, Qt.AspectRatioMode.KeepAspectRatio, mode)
        self.preview_came.emit()

    def _on_look(self, event: LookEvent) -> None:
        self.look_came.emit(event)

    def close(self) -> None:
        """Stop the timers and the channel."""
        self.log_out("window closed")
        self._renew.stop()
        self._idle.stop()
        self.bridge.close()


def shows(preview: Preview | None, part: PartEvent) -> bool:
    """Whether a picture is of that part; parts that could not be recorded have no number of their own."""
    return preview is not None and preview.inspection_id == part.record.inspection_id > 0


def _bit(bit: int) -> str:
    return str(Status(bit).name) if bit else "–"
