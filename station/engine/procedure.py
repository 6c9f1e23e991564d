"""Procedure for a part, a test image or a master: grab, judge, record, answer the PLC, show.

A verdict is published only after its record is durable; every error on the way ends in the verdict ERROR.
"""

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from station.archive.writer import Archive
from station.camera.reconnecting import Grab, ReconnectingCamera
from station.channel.events import PartEvent
from station.channel.preview import make_preview
from station.defects import Reason
from station.domain import Frame, Inspection, Origin, Purpose, Timing
from station.engine.alarm_log import AlarmLog
from station.engine.listener import Listener
from station.engine.plc_result import plc_result
from station.engine.recording import mark_shown, note_in_progress, unrecorded, write_record
from station.engine.self_checks import SelfChecks
from station.inspection.inspector import Inspector
from station.inspection.loading import Loaded
from station.plc.map.codes import ERROR_DEADLINE
from station.plc.map.registers import VerdictCode
from station.plc.port import Line, Trigger
from station.records import Part, Record

log = logging.getLogger("weldgate.cycle")


@dataclass(frozen=True, slots=True)
class PlcAnswer:
    """What the PLC reads of an inspection."""

    verdict: VerdictCode
    shown: bool
    """True if the result was published in time."""
    publish_ms: float


NO_PLC_ANSWER = PlcAnswer(VerdictCode.NONE, shown=False, publish_ms=0.0)
"""Answer for an inspection that an operator requested: the PLC reads nothing of it."""


class Procedure:
    """Inspects what is in the nest, for the PLC or for an operator."""

    def __init__(
        self,
        *,
        camera: ReconnectingCamera,
        origin: Origin,
        line: Line,
        archive: Archive,
        self_checks: SelfChecks,
        listener: Listener,
        alarm_log: AlarmLog,
        check_in: Callable[[], None],
    ) -> None:
        """`origin`: origin of the camera's frames; `check_in` reports the station's health to the line."""
        self._camera, self._origin = camera, origin
        self._line, self._check_in = line, check_in
        self._archive, self._self_checks = archive, self_checks
        self._listener, self._alarm_log = listener, alarm_log

    def inspect_part(self, trigger: Trigger, loaded: Loaded) -> None:
        """Inspect the part or master of a trigger and answer the PLC."""
        part = self.part_of(trigger)
        note_in_progress(self._archive, part)
        self._inspect(self._grab_for(trigger), part, loaded, trigger)

    def inspect_now(self, master: str, loaded: Loaded) -> None:
        """Inspect what is in the nest now, without the PLC; `master`: serial of a master, or empty."""
        purpose = Purpose.GOLDEN if master else Purpose.TEST
        self._inspect(self._grab(), Part(master, 0, self._origin, purpose), loaded, None)

    def show_error(self, trigger: Trigger, loaded: Loaded) -> None:
        """Show ERROR for a trigger whose inspection failed, so that no old verdict stays in the window."""
        self._alarm_log.add_event(ERROR_DEADLINE, f"trigger {trigger.trigger_id}, {trigger.serial}")
        record = unrecorded(Inspection.error(Reason.INTERNAL), self.part_of(trigger), loaded.provenance)
        self._listener.event(
            PartEvent(
                at_s=time.monotonic(),
                record=record,
                novel=False,
                drift=None,
                reported=VerdictCode.ERROR,
                record_ms=0.0,
                publish_ms=0.0,
            )
        )

    def _inspect(self, grab: Grab, part: Part, loaded: Loaded, trigger: Trigger | None) -> None:
        """Judge, record, answer and show what was grabbed; without a `trigger` the PLC is not answered."""
        pending = self._archive.begin(grab.frame)
        inspection = _judge(grab, loaded.inspector)
        start = time.perf_counter()
        if grab.frame is not None:
            part = replace(part, origin=grab.frame.origin)
        record = write_record(self._archive, pending, inspection, part, provenance=loaded.provenance)
        record_ms = _ms_since(start)
        self._update_self_checks(record, trigger)
        novel = loaded.inspector.is_novel(record.inspection)
        answer = NO_PLC_ANSWER if trigger is None else self._answer_plc(trigger, record, novel)
        mark_shown(self._archive, record, answer.shown)
        event = PartEvent(
            at_s=time.monotonic(),
            record=record,
            novel=novel,
            drift=self._self_checks.drift,
            reported=answer.verdict,
            record_ms=record_ms,
            publish_ms=answer.publish_ms,
        )
        self._show(grab.frame, event)

    def part_of(self, trigger: Trigger) -> Part:
        """Return the part or master that a trigger is about."""
        purpose = Purpose.GOLDEN if trigger.golden else Purpose.PART
        return Part(trigger.serial, trigger.trigger_id, self._origin, purpose)

    def _grab_for(self, trigger: Trigger) -> Grab:
        """Grab the part of this trigger; no frame if the trigger has ended and another part may be there."""
        if not self._line.awaits_result(trigger):
            return Grab(None, Reason.ABORTED, None)
        grab = self._grab(trigger.accepted_s)
        self._line.exposure_done(trigger)
        return grab

    def _grab(self, trigger_s: float | None = None) -> Grab:
        """Grab with the exposure of the settings, never with one that is tried by hand."""
        self._camera.adjust(None, None)
        return self._camera.grab(trigger_s)

    def _update_self_checks(self, record: Record, trigger: Trigger | None) -> None:
        """Update the self-checks by this record; test images do not count for the drift."""
        if trigger is not None:
            self._self_checks.part_judged(record.inspection)
        if record.purpose is Purpose.GOLDEN:
            self._self_checks.master_judged(record.serial, record.verdict)

    def _answer_plc(self, trigger: Trigger, record: Record, novel: bool) -> PlcAnswer:
        """Publish the result of a trigger; problems with it become alarm events and log entries."""
        self._check_in()
        start = time.perf_counter()
        drifting, trusted = self._self_checks.drifting, self._self_checks.trusted
        result = plc_result(trigger, record, novel=novel, drifting=drifting, trusted=trusted)
        shown = self._line.publish(result)
        publish_ms = _ms_since(start)
        if result.error_code or not shown:
            code = result.error_code if shown else self._line.state().error_code or ERROR_DEADLINE
            detail = f", {record.inspection.detail}" if shown and record.inspection.detail else ""
            self._alarm_log.add_event(code, f"part {record.inspection_id}{detail}")
        if not shown:
            log.warning(
                "part %d, %s: verdict %s came too late for the PLC",
                record.inspection_id,
                record.serial,
                record.verdict,
            )
        if record.inspection.detail is not None:
            log.warning(
                "part %d, %s: %s, %s",
                record.inspection_id,
                record.serial,
                record.inspection.reason,
                record.inspection.detail,
            )
        elif novel:
            log.warning(
                "part %d, %s: unlike the training images (distance %.2f); check light, focus and surface",
                record.inspection_id,
                record.serial,
                record.inspection.novelty,
            )
        return PlcAnswer(result.verdict if shown else VerdictCode.ERROR, shown, publish_ms)

    def _show(self, frame: Frame | None, event: PartEvent) -> None:
        self._listener.event(event)
        if frame is not None:
            inspection_id, ring = event.record.inspection_id, event.record.inspection.ring
            um_per_px = event.record.provenance.um_per_px
            self._listener.preview(make_preview(inspection_id, frame.image, ring, um_per_px=um_per_px))


def _judge(grab: Grab, inspector: Inspector) -> Inspection:
    timing = Timing(grab_ms=grab.grab_ms)
    if grab.frame is None:
        return Inspection.error(grab.reason or Reason.INTERNAL, timing=timing, detail=grab.detail)
    try:
        inspection = inspector.inspect(grab.frame.image, grab.grab_ms)
        if inspection.ring is None and (problem := inspector.view_problem(grab.frame.image)):
            log.error("%s: %s", grab.frame.source, problem)
        return inspection
    except Exception:  # the PLC needs an answer: a part with any fault is "not judged"
        log.exception("inspection failed")
        return Inspection.error(Reason.INTERNAL, timing=timing)


def _ms_since(start: float) -> float:
    return (time.perf_counter() - start) * 1000
