"""The engine: one trigger, one part, one record, one answer. Owns no device's details.

A verdict is published only after its record is durable; whatever goes wrong on the way ends in ERROR.
"""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import UTC, datetime

import numpy as np

from station.archive import Archive, Pending
from station.camera.port import Camera
from station.classify.drift import Drift, DriftWatch
from station.domain import Frame, Inspection, Origin, Reason, Timing, Verdict
from station.errors import CameraLost, FrameDamaged, FrameTimeout, LineError, RecordError
from station.events import Counts, Event, PartEvent, Preview, StatusEvent
from station.inspection import Inspector
from station.plc.handshake import ALL_SEGMENTS
from station.plc.port import Health, Line, Result, Trigger
from station.plc.registers import REASON_CODES, Flags, Offline, Status, VerdictCode
from station.preview import make_preview
from station.records import Provenance, Record

log = logging.getLogger("weldgate.cycle")

IDLE_S = 0.1
STATUS_S = 0.25
ALIVE_S = 1.0
ERROR_NOT_JUDGED = 0x1000


@dataclass(frozen=True, slots=True)
class Listener:
    """Who hears of what happens; must not block."""

    event: Callable[[Event], None]
    preview: Callable[[Preview], None]


class Cycle:
    """Runs parts until told to stop."""

    def __init__(
        self,
        camera: Camera,
        origin: Origin,
        line: Line,
        inspector: Inspector,
        archive: Archive,
        provenance: Provenance,
        listener: Listener,
        reconnect_s: float,
    ) -> None:
        self._camera = camera
        self._origin = origin
        self._line = line
        self._inspector = inspector
        self._archive = archive
        self._provenance = provenance
        self._listener = listener
        self._reconnect_s = reconnect_s
        self._camera_there = False
        self._camera_message = "camera not opened yet"
        self._tried_s = -1e9
        self._alive_s = 0.0
        self._status_s = 0.0
        self._counts = Counts()
        self._watch = None if inspector.reference is None else DriftWatch(inspector.reference)
        self._drift: Drift | None = None

    def run(self, stop: threading.Event) -> None:
        """Serve triggers until `stop`; closes the camera at the end."""
        try:
            while not stop.is_set():
                self._look_after_camera()
                self._line.checked_in(self._health())
                self._tell_status()
                trigger = self._line.next_trigger(IDLE_S)
                if trigger is not None:
                    self._guarded(trigger)
        finally:
            self._camera.close()

    def _look_after_camera(self) -> None:
        now = time.monotonic()
        if self._camera_there and now - self._alive_s >= ALIVE_S:
            self._alive_s = now
            if not self._camera.alive():
                self._lost("camera stopped answering")
        if not self._camera_there and now - self._tried_s >= self._reconnect_s:
            try:
                self._camera.open()
            except CameraLost as error:
                self._lost(str(error))
            else:
                log.info("camera opened")
                self._camera_there, self._camera_message, self._alive_s = True, "", now
            self._tried_s = time.monotonic()

    def _lost(self, message: str) -> None:
        if message != self._camera_message:
            log.warning("%s", message)
        self._camera_there, self._camera_message = False, message

    def _health(self) -> Health:
        room = self._archive.has_room()
        offline = Offline.NONE
        if not self._camera_there:
            offline = Offline.CAMERA_LOST
        elif not room:
            offline = Offline.ARCHIVE_FULL
        drifting = self._drift is not None and self._drift.alarm
        return Health(offline is Offline.NONE, offline, offline is not Offline.NONE, self._provenance.config_crc, drifting)

    def _tell_status(self) -> None:
        now = time.monotonic()
        if now - self._status_s < STATUS_S:
            return
        self._status_s = now
        published = self._line.status()
        status = Status(published["STATUS"])
        self._listener.event(
            StatusEvent(
                camera_there=self._camera_there,
                camera_message=self._camera_message,
                online=Status.ONLINE in status,
                ready=Status.READY in status,
                offline=Offline(published["OFFLINE_REASON"]),
                origin=self._origin,
                counts=self._counts,
            )
        )

    def _guarded(self, trigger: Trigger) -> None:
        """A fault nobody foresaw costs one part, not the station: the handshake answers ERROR at its deadline."""
        try:
            self._part(trigger)
        except LineError:
            raise
        except Exception:
            log.exception("part of trigger %d was not answered", trigger.trigger_id)

    def _part(self, trigger: Trigger) -> None:
        frame, inspection = self._take(trigger)
        pending = self._archive.begin(frame)
        if frame is not None:
            inspection = self._judge(frame, inspection.timing)
            self._see_drift(inspection)
        start = time.perf_counter()
        record = self._record(trigger, pending, inspection)
        record_ms = (time.perf_counter() - start) * 1000
        start = time.perf_counter()
        shown = self._line.publish(self._result(trigger, record))
        publish_ms = (time.perf_counter() - start) * 1000
        self._count(record.verdict if shown else Verdict.ERROR)
        if not shown:
            log.warning(
                "part %d, %s: came too late, the PLC was not shown its verdict %s", record.inspection_id, record.serial, record.verdict
            )
        self._mark(record, shown)
        novel = self._inspector.is_novel(record.inspection)
        if novel:
            log.warning(
                "part %d, %s: unlike the training images (distance %.2f); check light, focus and surface",
                record.inspection_id,
                record.serial,
                record.inspection.novelty,
            )
        self._listener.event(PartEvent(record, self._seg_nok(record.inspection), novel, self._drift, shown, record_ms, publish_ms))
        if frame is not None:
            self._listener.preview(make_preview(record.inspection_id, frame.image, record.inspection.ring))

    def _see_drift(self, inspection: Inspection) -> None:
        if self._watch is None or not inspection.look:
            return
        before, self._drift = self._drift, self._watch.part(np.array(inspection.look))
        if self._drift.alarm and not (before is not None and before.alarm):
            log.warning("the pictures drift (%.2f, limit %.2f); check light, focus and surface", self._drift.value, self._drift.limit)
        elif before is not None and before.alarm and not self._drift.alarm:
            log.info("the pictures are as they were (%.2f)", self._drift.value)

    def _mark(self, record: Record, shown: bool) -> None:
        try:
            self._archive.mark_shown(record.inspection_id, shown)
        except RecordError as error:
            log.error("%s", error)

    def _take(self, trigger: Trigger) -> tuple[Frame | None, Inspection]:
        """The frame of this trigger's part; none if the trigger is over and another part may lie there."""
        if not self._line.in_work(trigger):
            return None, Inspection.error(Reason.ABORTED)
        frame, inspection = self._grab()
        self._line.exposure_done(trigger)
        return frame, inspection

    def _record(self, trigger: Trigger, pending: Pending, inspection: Inspection) -> Record:
        """The durable record, or, if it cannot be made durable, one in memory that says ERROR."""
        now = datetime.now(UTC)
        try:
            return self._archive.commit(pending, inspection, trigger.serial, trigger.trigger_id, self._provenance, self._origin, now)
        except RecordError as error:
            log.error("%s", error)
        failed = Inspection.error(Reason.RECORD_FAILED, inspection.ring, inspection.quality, inspection.timing)
        return Record(0, trigger.serial, trigger.trigger_id, now, "", self._origin, None, None, failed, self._provenance)

    def _grab(self) -> tuple[Frame | None, Inspection]:
        """A frame, or why there is none."""
        start = time.perf_counter()
        frame, reason = None, Reason.INTERNAL
        if not self._camera_there:
            reason = Reason.CAMERA_LOST
        else:
            try:
                frame = self._camera.grab()
            except FrameTimeout as error:
                log.warning("%s", error)
                reason = Reason.NO_FRAME
            except FrameDamaged as error:
                log.warning("%s", error)
                reason = Reason.WRONG_SIZE if error.wrong_size else Reason.INCOMPLETE_FRAME
            except CameraLost as error:
                self._lost(str(error))
                reason = Reason.CAMERA_LOST
        return frame, Inspection.error(reason, timing=Timing(grab_ms=(time.perf_counter() - start) * 1000))

    def _judge(self, frame: Frame, timing: Timing) -> Inspection:
        try:
            return self._inspector.inspect(frame.image, timing.grab_ms)
        except Exception:  # the gate must answer: any fault is "not judged"
            log.exception("inspection failed")
            return Inspection.error(Reason.INTERNAL, timing=timing)

    def _seg_nok(self, inspection: Inspection) -> tuple[bool, ...]:
        return tuple(self._inspector.is_nok(s) for s in inspection.scores)

    def _result(self, trigger: Trigger, record: Record) -> Result:
        inspection = record.inspection
        nok, novel = self._seg_nok(inspection), self._inspector.is_novel(inspection)
        reason = 0 if inspection.reason is None else REASON_CODES[inspection.reason]
        flags = Flags.SIMULATED if self._origin is Origin.SIMULATED else Flags(0)
        if novel:
            flags |= Flags.NOVEL
        if self._drift is not None and self._drift.alarm:
            flags |= Flags.DRIFT
        return Result(
            trigger=trigger,
            verdict=verdict_code(inspection.verdict, self._origin),
            inspection_id=record.inspection_id,
            reason=reason,
            error_code=ERROR_NOT_JUDGED + reason if inspection.verdict is Verdict.ERROR else 0,
            seg_scores=tuple(round(min(max(s.nok, 0.0), 1.0) * 10_000) for s in inspection.scores),
            seg_nok_mask=sum(1 << i for i, bad in enumerate(nok) if bad),
            seg_invalid_mask=0 if inspection.scores else ALL_SEGMENTS,
            flags=flags,
        )

    def _count(self, verdict: Verdict) -> None:
        name = {Verdict.OK: "ok", Verdict.NOK: "nok", Verdict.ERROR: "error"}[verdict]
        self._counts = replace(self._counts, **{name: getattr(self._counts, name) + 1})


def verdict_code(verdict: Verdict, origin: Origin) -> VerdictCode:
    """What the PLC reads: a replayed part never releases anything."""
    if verdict is Verdict.ERROR:
        return VerdictCode.ERROR
    if origin is Origin.REPLAY:
        return VerdictCode.TEST
    return VerdictCode.OK if verdict is Verdict.OK else VerdictCode.NOK
