"""Starts the engine: opens everything that it needs and reports all failures at once."""

import logging
import threading
from collections.abc import Callable
from contextlib import ExitStack, closing
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TypeVar

from station.archive.reader import Query, find, read_words
from station.archive.writer import Archive
from station.camera.choose import make_camera
from station.camera.reconnecting import ReconnectingCamera
from station.channel.events import Event
from station.channel.request_socket import RequestServer
from station.channel.zeromq import Publisher
from station.defects import Reason
from station.domain import Purpose, Verdict
from station.engine.active_settings import ActiveSettings
from station.engine.alarm_log import AlarmLog
from station.engine.archive_identity import check_archive, note_archive
from station.engine.check_ins import DISK_S, WIRE_S, CheckIns
from station.engine.cycle import Cycle
from station.engine.listener import Listener
from station.engine.operator_requests import OperatorRequests
from station.engine.orders import OrderQueue
from station.engine.recording import INTERRUPTED, record_interrupted
from station.engine.retention import Housekeeping
from station.engine.self_checks import History, Master, SelfChecks
from station.engine.watchdog import StopSignals, Watchdog, nothing
from station.errors import RecordError, WeldgateError
from station.inspection.loading import Loaded, prepare
from station.journal.journal import Kind
from station.journal.journal_writer import append
from station.plc.bus_log import BusLog
from station.plc.line import make_line
from station.plc.map.alarms import ENGINE_HUNG
from station.plc.map.registers import ERROR_NOT_JUDGED
from station.plc.port import Line
from station.records import Provenance
from station.settings import adjustments
from station.settings.file import load
from station.settings.model import Settings

log = logging.getLogger("weldgate")

CHECKS_READ = 50
"""Number of newest checks of each master that are read at the start."""

Opened = TypeVar("Opened")


def make_cycle(
    settings: Settings,
    loaded: Loaded,
    *,
    line: Line,
    archive: Archive,
    listener: Listener,
    alarm_log: AlarmLog,
    active: ActiveSettings | None = None,
    clock_in_doubt: Callable[[], bool] = lambda: False,
    check_ins: CheckIns | None = None,
) -> Cycle:
    """Return the cycle that the settings describe; `active`: active settings that others may change."""
    golden = settings.golden
    masters, history = dict[str, Master](), History()
    for serial, found in golden.masters.items():
        masters[serial], before = _master(settings.archive.folder, serial, Verdict(found), loaded.provenance)
        history |= before
    return Cycle(
        camera=ReconnectingCamera(make_camera(settings.camera), settings.camera.reconnect_s),
        origin=settings.camera.origin,
        line=line,
        archive=archive,
        loaded=loaded,
        active=active or ActiveSettings(settings, lambda: settings, make_camera),
        self_checks=SelfChecks(
            loaded,
            masters,
            None if golden.due_h is None else golden.due_h * 3600,
            settings.model.self_test_s,
            self_test_age_s=settings.model.self_test_age_s,
            history=history,
        ),
        listener=listener,
        alarm_log=alarm_log,
        clock_in_doubt=clock_in_doubt,
        check_ins=check_ins,
    )


def _master(folder: Path, serial: str, expected: Verdict, judge: Provenance) -> tuple[Master, History]:
    """Return a master as `judge` starts with it, and its last check before this start by each judge.

    If the last of all was wrong, that counts; else only a check by `judge` itself proves something.
    """
    history: History = {}
    newest = Master(expected)
    query = Query(serial=serial, purpose=Purpose.GOLDEN, newest_first=True, limit=CHECKS_READ)
    for row in reversed(find(folder, query)):
        newest = Master(expected, Verdict(row.verdict), datetime.fromisoformat(row.grabbed_at).timestamp())
        record, _problem = read_words(folder, row)
        if record is not None:
            history[serial, record.provenance] = newest
    if newest.wrong:
        return newest, history
    return history.get((serial, judge), Master(expected)), history


def _archive(path: Path, settings: Settings) -> Archive:
    """Open the archive of this station. Raises RecordError, also if it is not the one that it was."""
    check_archive(path, settings.archive.folder)
    archive = Archive(settings.archive)
    try:
        note_archive(path, settings.archive.folder)
    except RecordError:
        archive.close()
        raise
    return archive


def run_engine(path: Path, at_end: Callable[[], None] = nothing) -> None:
    """Run the engine until SIGINT or SIGTERM. Raises WeldgateError that names everything that failed.

    `at_end` is called before the engine ends itself because a thread hangs.
    """
    settings = load(path)
    stop, check_ins = threading.Event(), CheckIns()
    at_hang: list[Callable[[], object]] = [at_end]

    def last_steps() -> None:
        for step in at_hang:
            step()

    with ExitStack() as stack:
        stack.enter_context(StopSignals(stop, last_steps))
        problems: list[str] = []

        def attempt(make: Callable[[], Opened]) -> Opened | None:
            try:
                return make()
            except WeldgateError as error:
                problems.append(str(error))
                return None

        loaded = attempt(lambda: prepare(settings, 1))
        publisher = attempt(lambda: stack.enter_context(closing(Publisher(settings.channel))))
        archive = attempt(lambda: stack.enter_context(closing(_archive(path, settings)))) if loaded else None
        bus = (
            attempt(
                lambda: stack.enter_context(
                    closing(
                        BusLog(
                            settings.archive.folder,
                            settings.archive.bus_days,
                            lambda: check_ins.working("bus", DISK_S),
                        )
                    )
                )
            )
            if archive
            else None
        )
        keeper = None
        if archive:
            keeper = stack.enter_context(
                closing(Housekeeping(settings.archive.folder, settings.archive.keep, check_ins=check_ins))
            )
        server = attempt(lambda: stack.enter_context(closing(RequestServer(settings.channel))))
        if (
            problems
            or loaded is None
            or publisher is None
            or archive is None
            or bus is None
            or server is None
        ):
            raise WeldgateError("; ".join(problems))
        line = make_line(settings.plc, bus, lambda: check_ins.expect("plc", WIRE_S))
        stack.callback(check_ins.rest, "plc")
        stack.callback(line.stop)
        line.start()
        for change in adjustments.words(path):
            log.warning("changed at the station, overrides %s: %s", path.name, change)
        log.info(
            "station started: model %s, PLC %s on port %d",
            loaded.provenance.model_version,
            settings.plc.mode,
            line.port,
        )
        alarm_log = stack.enter_context(closing(AlarmLog(settings.archive.folder, check_ins)))
        for record in record_interrupted(archive, loaded.provenance):
            code = ERROR_NOT_JUDGED + Reason.INTERNAL.code
            alarm_log.add_event(code, f"part {record.inspection_id}, {INTERRUPTED}")
        active, orders = ActiveSettings(settings, lambda: load(path), make_camera), OrderQueue()
        requests = stack.enter_context(
            closing(OperatorRequests(server, path, active, orders.put, check_ins=check_ins))
        )

        def on_event(event: Event) -> None:
            publisher.send(event)
            requests.on_event(event)

        cycle = make_cycle(
            settings,
            loaded,
            line=line,
            archive=archive,
            listener=Listener(on_event, publisher.show, orders.take),
            alarm_log=alarm_log,
            active=active,
            clock_in_doubt=lambda: keeper is not None and keeper.clock_in_doubt,
            check_ins=check_ins,
        )
        alarm = partial(append, settings.archive.folder, Kind.ALARM, "station", f"16#{ENGINE_HUNG:04X}")
        at_hang += [cycle.note_unserved, alarm]
        stack.enter_context(closing(Watchdog(check_ins, last_steps)))
        cycle.run(stop)
