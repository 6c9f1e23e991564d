"""The engine's loop: triggers and commands of the PLC, orders of operators, self-checks while idle."""

import logging
import threading
from collections.abc import Callable
from functools import partial

from station.archive.writer import Archive
from station.camera.reconnecting import ReconnectingCamera
from station.domain import Origin
from station.engine.active_settings import ActiveSettings
from station.engine.alarm_log import AlarmLog
from station.engine.check_ins import IDLE_S, CheckIns
from station.engine.health import StationState, health
from station.engine.listener import Listener
from station.engine.operator_orders import OperatorOrders, no_part_in_progress
from station.engine.orders import Reload, Service, UseSettings
from station.engine.procedure import Procedure
from station.engine.recording import note_in_progress
from station.engine.self_checks import SelfChecks
from station.engine.settings_use import RELOAD_REFUSED, use_settings
from station.engine.setup_image import take_setup_image
from station.engine.status_report import StatusReport
from station.errors import LineError, WeldgateError
from station.inspection.loading import Loaded
from station.plc.map.registers import Offline
from station.plc.port import Command, Line, Trigger

log = logging.getLogger("weldgate.cycle")

PART_GRACE_S = 10.0
"""Time that a part may take beyond grab, deadline and the wait for the PLC before the cycle hangs."""
WAIT_S = 0.1
"""Longest wait for a trigger or command before the other tasks have their turn."""


class Cycle:
    """The loop that inspects parts until it is stopped. Use from one thread."""

    def __init__(
        self,
        *,
        camera: ReconnectingCamera,
        origin: Origin,
        line: Line,
        archive: Archive,
        loaded: Loaded,
        active: ActiveSettings,
        self_checks: SelfChecks,
        listener: Listener,
        alarm_log: AlarmLog,
        clock_in_doubt: Callable[[], bool] = lambda: False,
        check_ins: CheckIns | None = None,
    ) -> None:
        """`origin`: origin of the camera's frames; `loaded`: the recipe to start with."""
        self._check_ins = check_ins or CheckIns()
        self._clock_in_doubt = clock_in_doubt
        self._camera = camera
        self._line = line
        self._archive = archive
        self._loaded = loaded
        self._active = active
        self._self_checks = self_checks
        self._listener = listener
        self._orders = OperatorOrders()
        self._settings_refused = False
        self._reload_refusal = ""
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
            self_checks=self_checks,
            listener=listener,
            alarm_log=alarm_log,
            check_in=self._check_in,
        )

    def run(self, stop: threading.Event) -> None:
        """Serve triggers until `stop` is set, then close the camera. Raises LineError."""
        try:
            while not stop.is_set():
                self._check_ins.expect("cycle", IDLE_S)
                self._camera.keep_open()
                self._take_orders()
                state = self._state()
                self._line.check_in(health(state))
                self._status.send(state)
                request = self._line.next_request(WAIT_S)
                if isinstance(request, Trigger):
                    self._serve(request)
                    self._self_checks.run_between_parts()
                elif isinstance(request, Command):
                    self._line.command_done(request, self._load_recipe(request))
                elif not self._carry_out_order():
                    self._self_checks.run_when_idle()
        finally:
            self._camera.close()
            self._check_ins.rest("cycle")

    def note_unserved(self) -> None:
        """Note on disk a trigger that the cycle never took, as it hangs; call from another thread."""
        request = self._line.next_request(0)
        if isinstance(request, Trigger):
            note_in_progress(self._archive, self._procedure.part_of(request), waits=True)

    def _serve(self, trigger: Trigger) -> None:
        settings = self._active.settings
        part_s = settings.camera.grab_s + 2 * settings.plc.deadline_ms / 1000 + PART_GRACE_S
        self._check_ins.expect("cycle", part_s)
        failed = f"part of trigger {trigger.trigger_id} was not answered"
        answered = self._guarded(partial(self._procedure.inspect_part, trigger, self._loaded), failed)
        if not answered and self._line.awaits_result(trigger):
            self._guarded(partial(self._procedure.show_error, trigger, self._loaded), failed)

    def _take_orders(self) -> None:
        for order in self._orders.take_in(self._listener.orders()):
            self._line.reset_counts()
            log.info("counters were reset by %s", order.who)

    def _carry_out_order(self) -> bool:
        """Carry out one order if no part is in progress; return whether there was anything to do."""
        status = self._line.state().status
        task, setup = self._orders.next_task(status), self._orders.service.setup_images
        if isinstance(task, Reload):
            self._reload_refusal = RELOAD_REFUSED
            self._guarded(self._reload, "the settings file was not read again")
            task.ticket.answer(self._reload_refusal if self._settings_refused else "")
        elif isinstance(task, UseSettings):
            work = partial(
                use_settings,
                task,
                active=self._active,
                camera=self._camera,
                number=self._loaded.number,
                use=self._use,
            )
            self._guarded(work, "changed settings are not used")
            self._settings_refused &= bool(task.ticket.refusal)
        elif task is not None:
            inspect = partial(self._procedure.inspect_now, task.master, self._loaded)
            self._guarded(inspect, "the test image was not judged")
        elif setup is not None and no_part_in_progress(status):
            self._guarded(partial(self._take_setup_image, setup), "no setup image was taken")
        return task is not None or setup is not None

    def _take_setup_image(self, request: Service) -> None:
        event, preview = take_setup_image(self._camera, self._loaded.inspector, request)
        self._listener.event(event)
        if preview is not None:
            self._listener.preview(preview)

    def _reload(self) -> None:
        """Use the settings that the file holds now; the previous ones stay active if they cannot be used."""
        self._settings_refused = True
        try:
            prepared = self._active.prepare_file(self._loaded.number)
        except WeldgateError as error:
            log.error("changed settings are not used: %s", error)
            self._reload_refusal = str(error)
            return
        if prepared.camera is None or self._camera.replace(prepared.camera):
            self._settings_refused = False
            self._active.activate(prepared)
            self._use(prepared.loaded)

    def _load_recipe(self, command: Command) -> bool:
        """Load the recipe that the PLC asks for; return False if the previous one stays active."""
        number = command.arg
        try:
            loaded = self._active.load_recipe(number)
        except WeldgateError as error:
            log.error("recipe %d was not loaded: %s", number, error)
            return False
        except Exception:  # the previous recipe stays active
            log.exception("recipe %d was not loaded", number)
            return False
        if not self._line.awaits_command(command):
            log.error("recipe %d was loaded too late; the previous one stays active", number)
            return False
        self._use(loaded)
        return True

    def _use(self, loaded: Loaded) -> None:
        self._loaded = loaded
        self._self_checks.use(loaded)
        self._check_in()
        log.info("recipe %d is active, configuration %d", loaded.number, loaded.provenance.config_crc)

    def _state(self) -> StationState:
        checks = self._self_checks
        return StationState(
            camera_connected=self._camera.connected,
            can_write=self._archive.has_room(),
            room=self._archive.room(),
            plc_silent=self._line.state().offline is Offline.PLC_SILENT,
            self_test_failed=checks.self_test_failed,
            master_wrong=checks.master_wrong,
            masters_due=checks.masters_due,
            drifting=checks.drifting,
            settings_refused=self._settings_refused,
            clock_in_doubt=self._clock_in_doubt(),
            service=self._orders.service.who,
            order_waiting=self._orders.waiting,
            bit=self._orders.service.bit,
            recipe=self._loaded.provenance.recipe,
            config_crc=self._loaded.provenance.config_crc,
        )

    def _check_in(self) -> None:
        self._line.check_in(health(self._state()))

    def _guarded(self, work: Callable[[], None], failed: str) -> bool:
        """Do `work` and return whether it succeeded; an unexpected fault is logged as `failed`.

        Such a fault costs one part, not the station: the handshake shows ERROR at its deadline.
        """
        try:
            work()
        except LineError:
            raise
        except Exception:
            log.exception(failed)
            return False
        return True
