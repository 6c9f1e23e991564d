"""Opens what the engine needs and reports every failure at once; the only place that chooses by kind."""

import logging
import signal
import threading
from collections.abc import Callable
from contextlib import ExitStack, closing
from pathlib import Path
from types import FrameType
from typing import TypeVar

from station.archive.prune import Housekeeping
from station.archive.reader import Wanted, find
from station.archive.writer import Archive
from station.camera.port import Camera
from station.camera.reconnecting import ReconnectingCamera
from station.channel import Inbox, Publisher
from station.cycle import Cycle, Listener
from station.domain import Purpose, Verdict
from station.errors import WeldgateError
from station.plc.buslog import BusLog
from station.plc.line import make_line
from station.plc.port import Line
from station.recipe import Loaded, prepare
from station.settings import PylonSettings, Settings
from station.watch import Watch

log = logging.getLogger("weldgate")

Opened = TypeVar("Opened")


def make_camera(settings: Settings) -> Camera:
    """The camera that the settings name, not yet open."""
    if isinstance(settings.camera, PylonSettings):
        from station.camera.pylon import PylonCamera

        return PylonCamera(settings.camera)
    from station.camera.replay import ReplayCamera

    return ReplayCamera(settings.camera)


def make_cycle(settings: Settings, loaded: Loaded, line: Line, archive: Archive, listener: Listener) -> Cycle:
    """The cycle that the settings describe; recipes are loaded by the same settings."""
    masters = {serial: Verdict(found) for serial, found in settings.golden.masters.items()}
    return Cycle(
        camera=ReconnectingCamera(make_camera(settings), settings.camera.reconnect_s),
        origin=settings.camera.origin,
        line=line,
        archive=archive,
        loaded=loaded,
        prepare=lambda number: prepare(settings, number),
        watch=Watch(loaded, masters, _wrong_masters(settings.archive.folder, masters), settings.model.self_test_s),
        listener=listener,
    )


def _wrong_masters(folder: Path, masters: dict[str, Verdict]) -> list[str]:
    """Masters whose last golden check, before this start, found something else."""
    wrong = []
    for serial, true in masters.items():
        checks = [row for row in find(folder, Wanted(serial=serial)) if row.purpose == Purpose.GOLDEN]
        if checks and checks[-1].verdict != true:
            wrong.append(serial)
    return wrong


def run_engine(settings: Settings) -> None:
    """Run until SIGINT or SIGTERM. Raises WeldgateError naming all that failed at start."""
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
        bus = tried(lambda: stack.enter_context(closing(BusLog(settings.archive.folder, settings.archive.bus_days)))) if archive else None
        if archive:
            stack.enter_context(closing(Housekeeping(settings.archive.folder, settings.archive.keep)))
        inbox = tried(lambda: stack.enter_context(closing(Inbox(settings.channel))))
        if problems or loaded is None or publisher is None or archive is None or bus is None or inbox is None:
            raise WeldgateError("; ".join(problems))
        line = make_line(settings.plc, bus)
        stack.callback(line.stop)
        line.start()
        log.info("station up: model %s, PLC %s on port %d", loaded.provenance.model_version, settings.plc.mode, line.port)
        cycle = make_cycle(settings, loaded, line, archive, Listener(publisher.send, publisher.show, inbox.asked))
        cycle.run(stop)
