"""The engine: one trigger, one part, one record, one answer. Owns no device's details.

A verdict is published only after its record is durable; whatever goes wrong on the way ends in ERROR.
"""

import logging
import threading
import time
from collections.abc import Callable
from functools import partial

from station.alarmlog import AlarmLog
from station.answer import answer
from station.archive.writer import Archive
from station.camera.reconnecting import ReconnectingCamera
from station.condition import Seen, alarms, health
from station.defects import Reason
from station.domain import Frame, Inspection, Origin, Purpose, Timing
from station.errors import LineError, WeldgateError
from station.events import PartEvent, StatusEvent
from station.listener import Listener
from station.plc.codes import ERROR_DEADLINE
from station.plc.port import Command, Health, Line, Trigger
from station.plc.registers import STATUS_START, Offline, Status, VerdictCode, word
from station.preview import make_preview
from station.recipe import Loaded
from station.recorder import keep, mark_shown, unkept
from station.records import Part, Record
from station.released import Released
from station.requests import Reload, ResetCounts, Service
from station.service import Attention, drained, look
from station.watch import Watch

log = logging.getLogger("weldgate.cycle")

IDLE_S = 0.1
STATUS_S = 0.25


class Cycle:
    """Runs parts until told to stop."""

    def __init__(
        self,
        camera: ReconnectingCamera,
        origin: Origin,
        line: Line,
        archive: Archive,
        loaded: Loaded,
        released: Released,
        watch: Watch,
        listener: Listener,
        alarm_log: AlarmLog,
    ) -> None:
        """`released`: settings in use."""
        self._camera = camera
        self._origin = origin
        self._line = line
        self._archive = archive
        self._loaded = loaded
        self._released = released
        self._watch = watch
        self._listener, self._alarm_log = listener, alarm_log
        self._attention = Attention()
        self._settings_refused = False
        self._status_s, self._started_s, self._reloaded_s = 0.0, time.monotonic(), 0.0

    def run(self, stop: threading.Event) -> None:
        """Serve triggers until `stop`; closes the camera at the end."""
        try:
            while not stop.is_set():
                self._camera.look_after()
                self._hear()
                self._line.checked_in(self._health())
                self._tell_status()
                request = self._line.next_request(IDLE_S)
                if isinstance(request, Trigger):
                    what = f"part of trigger {request.trigger_id} was not answered"
                    if not self._guarded(partial(self._part, request), what) and self._line.in_work(request):
                        self._guarded(partial(self._unanswered, request), what)
                elif isinstance(request, Command):
                    self._line.command_done(request, self._load_recipe(request))
                elif not self._attend():
                    self._watch.idle()
        finally:
            self._camera.close()

    def _hear(self) -> None:
        requests = self._listener.requests()
        self._attention.hear(requests)
        for request in requests:
            if isinstance(request, ResetCounts):
                self._line.reset_counts()
                log.info("counters set back by %s", request.who)

    def _attend(self) -> bool:
        """What people ask for, once no part is in work. Whether there was anything to do."""
        status = Status(word(STATUS_START, self._line.windows()[1], "STATUS"))
        task, wanted = self._attention.due(status), self._attention.service.looking
        if isinstance(task, Reload):
            self._guarded(self._reload, "the settings were not read again")
            self._reloaded_s = task.asked_s
        elif task is not None:
            self._guarded(partial(self._test_picture, task.master), "the test picture was not judged")
        elif wanted is not None and drained(status):
            self._guarded(partial(self._look, wanted), "no picture for setting up")
        return task is not None or wanted is not None

    def _look(self, wanted: Service) -> None:
        event, preview = look(self._camera, self._loaded.inspector, wanted)
        self._listener.event(event)
        if preview is not None:
            self._listener.preview(preview)

    def _reload(self) -> None:
        """Use the settings as they are now; if they are no good, those before stay in use."""
        self._settings_refused = True
        try:
            change = self._released.changed(self._loaded.number)
        except WeldgateError as error:
            log.error("changed settings are not used: %s", error)
            return
        if change.camera is None or self._camera.exchange(change.camera):
            self._settings_refused = False
            self._released.accept(change)
            self._use(change.loaded)

    def _load_recipe(self, command: Command) -> bool:
        """Whether the recipe is in use now; if not, the one before still is."""
        number = command.arg
        try:
            loaded = self._released.prepare(number)
        except WeldgateError as error:
            log.error("recipe %d was not loaded: %s", number, error)
            return False
        except Exception:  # the recipe before is still in use
            log.exception("recipe %d was not loaded", number)
            return False
        if not self._line.wanted(command):
            log.error("recipe %d was loaded too late, the one before stays in use", number)
            return False
        self._use(loaded)
        return True

    def _use(self, loaded: Loaded) -> None:
        self._loaded = loaded
        self._watch.use(loaded)
        self._line.checked_in(self._health())
        log.info("recipe %d in use, configuration %d", loaded.number, loaded.provenance.config_crc)

    def _seen(self) -> Seen:
        watch = self._watch
        return Seen(
            camera_there=self._camera.there,
            can_write=self._archive.has_room(),
            room=self._archive.room(),
            plc_silent=word(STATUS_START, self._line.windows()[1], "OFFLINE_REASON") == Offline.PLC_SILENT,
            self_test_failed=watch.self_test_failed,
            master_wrong=watch.master_wrong,
            masters_due=watch.masters_due,
            drifting=watch.drifting,
            settings_refused=self._settings_refused,
            service=self._attention.service.who,
            attended=self._attention.waiting,
            bit=self._attention.service.bit,
            recipe=self._loaded.provenance.recipe,
            config_crc=self._loaded.provenance.config_crc,
        )

    def _health(self) -> Health:
        return health(self._seen())

    def _tell_status(self) -> None:
        now = time.monotonic()
        if now - self._status_s < STATUS_S:
            return
        self._status_s = now
        seen, (command, words) = self._seen(), self._line.windows()
        lasting = alarms(seen)
        self._alarm_log.lasting(lasting)
        self._listener.event(
            StatusEvent(
                at_s=now,
                started_s=self._started_s,
                reloaded_s=self._reloaded_s,
                camera_there=self._camera.there,
                camera_message=self._camera.message,
                origin=self._origin,
                alarms=tuple(int(code) for code in lasting),
                recipe=seen.recipe,
                config_crc=seen.config_crc,
                service=seen.service,
                command_words=command,
                status_words=words,
            )
        )

    def _guarded(self, work: Callable[[], None], failed: str) -> bool:
        """A fault nobody foresaw costs one part, not the station: the handshake answers ERROR at its deadline. Whether all went well."""
        try:
            work()
        except LineError:
            raise
        except Exception:
            log.exception(failed)
            return False
        return True

    def _unanswered(self, trigger: Trigger) -> None:
        """No old verdict stays on the screen."""
        self._alarm_log.passing(ERROR_DEADLINE, f"trigger {trigger.trigger_id}, {trigger.serial}")
        part = Part(trigger.serial, trigger.trigger_id, self._origin, Purpose.GOLDEN if trigger.golden else Purpose.PART)
        record = unkept(Inspection.error(Reason.INTERNAL), part, self._loaded.provenance)
        self._tell(None, PartEvent(time.monotonic(), record, (), False, None, VerdictCode.ERROR, 0.0, 0.0))

    def _part(self, trigger: Trigger) -> None:
        frame, inspection = self._take(trigger)
        pending = self._archive.begin(frame)
        if frame is not None:
            inspection = self._judge(frame, inspection.timing)
        start = time.perf_counter()
        purpose = Purpose.GOLDEN if trigger.golden else Purpose.PART
        origin = self._origin if frame is None else frame.origin
        part = Part(trigger.serial, trigger.trigger_id, origin, purpose)
        record = keep(self._archive, pending, inspection, part, self._loaded.provenance)
        record_ms = (time.perf_counter() - start) * 1000
        self._watch.part(record.inspection)
        if trigger.golden:
            self._watch.master(record.serial, record.verdict)
        self._line.checked_in(self._health())
        nok, novel = self._decided(record)
        start = time.perf_counter()
        result = answer(trigger, record, nok, novel, self._watch.drifting, self._watch.trusted)
        shown = self._line.publish(result)
        publish_ms = (time.perf_counter() - start) * 1000
        if result.error_code or not shown:
            told = word(STATUS_START, self._line.windows()[1], "ERROR_CODE")
            code = result.error_code if shown else told or ERROR_DEADLINE
            self._alarm_log.passing(code, f"part {record.inspection_id}")
        if not shown:
            log.warning(
                "part %d, %s: came too late, the PLC was not shown its verdict %s", record.inspection_id, record.serial, record.verdict
            )
        mark_shown(self._archive, record, shown)
        if novel:
            log.warning(
                "part %d, %s: unlike the training images (distance %.2f); check light, focus and surface",
                record.inspection_id,
                record.serial,
                record.inspection.novelty,
            )
        said = result.verdict if shown else VerdictCode.ERROR
        self._tell(frame, PartEvent(time.monotonic(), record, nok, novel, self._watch.drift, said, record_ms, publish_ms))

    def _test_picture(self, master: str) -> None:
        """A picture of what lies there now, judged and recorded; the PLC is told nothing, the counters stand still."""
        frame, inspection = self._grab()
        pending = self._archive.begin(frame)
        if frame is not None:
            inspection = self._judge(frame, inspection.timing)
        purpose = Purpose.GOLDEN if master else Purpose.TEST
        part = Part(master, 0, self._origin if frame is None else frame.origin, purpose)
        record = keep(self._archive, pending, inspection, part, self._loaded.provenance)
        if master:
            self._watch.master(record.serial, record.verdict)
        mark_shown(self._archive, record, False)
        nok, novel = self._decided(record)
        self._tell(frame, PartEvent(time.monotonic(), record, nok, novel, self._watch.drift, VerdictCode.NONE, 0.0, 0.0))

    def _decided(self, record: Record) -> tuple[tuple[bool, ...], bool]:
        """Which segments are refused, and whether the picture is unlike all training."""
        inspector = self._loaded.inspector
        return record.inspection.nok, inspector.is_novel(record.inspection)

    def _tell(self, frame: Frame | None, event: PartEvent) -> None:
        self._listener.event(event)
        if frame is not None:
            self._listener.preview(make_preview(event.record.inspection_id, frame.image, event.record.inspection.ring))

    def _take(self, trigger: Trigger) -> tuple[Frame | None, Inspection]:
        """The frame of this trigger's part; none if the trigger is over and another part may lie there."""
        if not self._line.in_work(trigger):
            return None, Inspection.error(Reason.ABORTED)
        frame, inspection = self._grab()
        self._line.exposure_done(trigger)
        return frame, inspection

    def _grab(self) -> tuple[Frame | None, Inspection]:
        """A frame, or why there is none; never with an exposure that somebody tries by hand."""
        self._camera.adjust(None, None)
        frame, reason, grab_ms = self._camera.grab()
        return frame, Inspection.error(reason or Reason.INTERNAL, timing=Timing(grab_ms=grab_ms))

    def _judge(self, frame: Frame, timing: Timing) -> Inspection:
        try:
            return self._loaded.inspector.inspect(frame.image, timing.grab_ms)
        except Exception:  # the gate must answer: any fault is "not judged"
            log.exception("inspection failed")
            return Inspection.error(Reason.INTERNAL, timing=timing)
