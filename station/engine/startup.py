"""Opens what the engine needs and reports every failure at once."""

import logging
import signal
import threading
from collections.abc import Callable
from contextlib import ExitStack, closing
from datetime import datetime
from pathlib import Path
from types import FrameType
from typing import TypeVar

from station.archive.prune import Housekeeping
from station.archive.reader import Query, find
from station.archive.writer import Archive
from station.camera.choose import make_camera
from station.camera.reconnecting import ReconnectingCamera
from station.channel.events import Event
from station.channel.zeromq import Publisher, RequestServer
from station.domain import Purpose, Verdict
from station.engine.active_settings import Released
from station.engine.alarm_log import AlarmLog
from station.engine.cycle import Cycle
from station.engine.listener import Listener
from station.engine.operator_requests import OperatorRequests
from station.engine.orders import OrderQueue
from station.engine.self_checks import Master, Watch
from station.errors import WeldgateError
from station.inspection.loading import Loaded, prepare
from station.plc.bus_log import BusLog
from station.plc.line import make_line
from station.plc.port import Line
from station.settings import adjustments
from station.settings.file import load
from station.settings.model import Settings

log = logging.getLogger("weldgate")

Opened = TypeVar("Opened")


def make_cycle(
    settings: Settings,
    loaded: Loaded,
    line: Line,
    archive: Archive,
    listener: Listener,
    alarm_log: AlarmLog,
    released: Released | None = None,
) -> Cycle:
    """Return the cycle that the settings describe; `released`: settings in use, which may change meanwhile."""
    golden = settings.golden
    return Cycle(
        camera=ReconnectingCamera(make_camera(settings.camera), settings.camera.reconnect_s),
        origin=settings.camera.origin,
        line=line,
        archive=archive,
        loaded=loaded,
        released=released or Released(settings, lambda: settings, make_camera),
        watch=Watch(
            loaded,
            {
                serial: _master(settings.archive.folder, serial, Verdict(found))
                for serial, found in golden.masters.items()
            },
            None if golden.due_h is None else golden.due_h * 3600,
            settings.model.self_test_s,
        ),
        listener=listener,
        alarm_log=alarm_log,
    )


def _master(folder: Path, serial: str, expected: Verdict) -> Master:
    """With its last check before this start."""
    checks = find(folder, Query(serial=serial, purpose=Purpose.GOLDEN, newest_first=True, limit=1))
    if not checks:
        return Master(expected)
    return Master(
        expected, Verdict(checks[0].verdict), datetime.fromisoformat(checks[0].grabbed_at).timestamp()
    )


def run_engine(path: Path) -> None:
    """Run by a settings file until SIGINT or SIGTERM. Raises WeldgateError naming all that failed at start."""
    settings = load(path)
    stop = threading.Event()

    def on_signal(_number: int, _frame: FrameType | None) -> None:
        stop.set()

    signal.signal(signal.SIGINT, on_signal)
    signal.signal(signal.SIGTERM, on_signal)

    with ExitStack() as stack:
        problems: list[str] = []

        def tried(make: Callable[[], Opened]) -> Opened | None:
            try:
                return make()
            except WeldgateError as error:
                problems.append(str(error))
                return None

        loaded = tried(lambda: prepare(settings, 1))
        publisher = tried(lambda: stack.enter_context(closing(Publisher(settings.channel))))
        archive = tried(lambda: stack.enter_context(closing(Archive(settings.archive)))) if loaded else None
        bus = (
            tried(
                lambda: stack.enter_context(
                    closing(BusLog(settings.archive.folder, settings.archive.bus_days))
                )
            )
            if archive
            else None
        )
        if archive:
            stack.enter_context(closing(Housekeeping(settings.archive.folder, settings.archive.keep)))
        server = tried(lambda: stack.enter_context(closing(RequestServer(settings.channel))))
        if (
            problems
            or loaded is None
            or publisher is None
            or archive is None
            or bus is None
            or server is None
        ):
            raise WeldgateError("; ".join(problems))
        line = make_line(settings.plc, bus)
        stack.callback(line.stop)
        line.start()
        for change in adjustments.words(path):
            log.warning("changed at the station, over %s: %s", path.name, change)
        log.info(
            "station up: model %s, PLC %s on port %d",
            loaded.provenance.model_version,
            settings.plc.mode,
            line.port,
        )
        alarm_log = stack.enter_context(closing(AlarmLog(settings.archive.folder)))
        released, orders = Released(settings, lambda: load(path), make_camera), OrderQueue()
        requests = stack.enter_context(closing(OperatorRequests(server, path, released, orders.put)))

        def heard(event: Event) -> None:
            publisher.send(event)
            requests.saw(event)

        listener = Listener(heard, publisher.show, orders.take)
        make_cycle(settings, loaded, line, archive, listener, alarm_log, released).run(stop)
