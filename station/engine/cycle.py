"""The engine's loop: triggers and commands of the PLC, requests of people, self-checks while idle."""

import logging
import threading
from collections.abc import Callable
from functools import partial

from station.archive.writer import Archive
from station.camera.reconnecting import ReconnectingCamera
from station.domain import Origin
from station.engine.active_settings import Released
from station.engine.alarm_log import AlarmLog
from station.engine.health import Seen, health
from station.engine.listener import Listener
from station.engine.orders import Reload, Service, UseSettings
from station.engine.procedure import Procedure
from station.engine.self_checks import Watch
from station.engine.service_mode import Attention, drained, look
from station.engine.settings_use import RELOAD_REFUSED, use_settings
from station.engine.status_report import StatusReport
from station.errors import LineError, WeldgateError
from station.inspection.loading import Loaded
from station.plc.map.registers import Offline
from station.plc.port import Command, Line, Trigger

log = logging.getLogger("weldgate.cycle")

IDLE_S = 0.1


class Cycle:
    """Runs parts until told to stop."""

    def __init__(
        self,
        *,
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
        self._line = line
        self._archive = archive
        self._loaded = loaded
        self._released = released
        self._watch = watch
        self._listener = listener
        self._attention = Attention()
        self._settings_refused = False
        self._reloaded_s = 0.0
        self._status = StatusReport(
            camera=camera,
            origin=origin,
            line=line,
            listener=listener,
            alarm_log=alarm_log,
        )
        self._procedure = Procedure(
            camera=camera,
            origin=origin,
            line=line,
            archive=archive,
            watch=watch,
            listener=listener,
            alarm_log=alarm_log,
            check_in=self._check_in,
        )

    def run(self, stop: threading.Event) -> None:
        """Serve triggers until `stop`; closes the camera at the end."""
        try:
            while not stop.is_set():
                self._camera.look_after()
                self._hear()
                seen = self._seen()
                self._line.check_in(health(seen))
                self._status.send(seen, self._reloaded_s)
                request = self._line.next_request(IDLE_S)
                if isinstance(request, Trigger):
                    self._serve(request)
                elif isinstance(request, Command):
                    self._line.command_done(request, self._load_recipe(request))
                elif not self._attend():
                    self._watch.idle()
        finally:
            self._camera.close()

    def _serve(self, trigger: Trigger) -> None:
        failed = f"part of trigger {trigger.trigger_id} was not answered"
        answered = self._guarded(partial(self._procedure.part, trigger, self._loaded), failed)
        if not answered and self._line.awaits_result(trigger):
            self._guarded(partial(self._procedure.unanswered, trigger, self._loaded), failed)

    def _hear(self) -> None:
        for order in self._attention.hear(self._listener.orders()):
            self._line.reset_counts()
            log.info("counters set back by %s", order.who)

    def _attend(self) -> bool:
        """What people ask for, once no part is in work. Whether there was anything to do."""
        status = self._line.state().status
        task, wanted = self._attention.due(status), self._attention.service.looking
        if isinstance(task, Reload):
            self._guarded(partial(self._reload, task), "the settings were not read again")
            task.ticket.answer(RELOAD_REFUSED if self._settings_refused else "")
        elif isinstance(task, UseSettings):
            work = partial(use_settings, task, self._released, self._camera, self._loaded.number, self._use)
            self._guarded(work, "changed settings are not used")
            self._settings_refused &= bool(task.ticket.refusal)
        elif task is not None:
            inspect = partial(self._procedure.test_image, task.master, self._loaded)
            self._guarded(inspect, "the test picture was not judged")
        elif wanted is not None and drained(status):
            self._guarded(partial(self._look, wanted), "no picture for setting up")
        return task is not None or wanted is not None

    def _look(self, wanted: Service) -> None:
        event, preview = look(self._camera, self._loaded.inspector, wanted)
        self._listener.event(event)
        if preview is not None:
            self._listener.preview(preview)

    def _reload(self, task: Reload) -> None:
        """Use the settings as they are now; if they are no good, those before stay in use."""
        self._settings_refused, self._reloaded_s = True, task.asked_s
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
        if not self._line.awaits_command(command):
            log.error("recipe %d was loaded too late, the one before stays in use", number)
            return False
        self._use(loaded)
        return True

    def _use(self, loaded: Loaded) -> None:
        self._loaded = loaded
        self._watch.use(loaded)
        self._check_in()
        log.info("recipe %d in use, configuration %d", loaded.number, loaded.provenance.config_crc)

    def _seen(self) -> Seen:
        watch = self._watch
        return Seen(
            camera_there=self._camera.there,
            can_write=self._archive.has_room(),
            room=self._archive.room(),
            plc_silent=self._line.state().offline is Offline.PLC_SILENT,
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

    def _check_in(self) -> None:
        self._line.check_in(health(self._seen()))

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
