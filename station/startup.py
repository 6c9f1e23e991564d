"""Opens what the engine needs and reports every failure at once; the only place that chooses by kind."""

import logging
import signal
import threading
import zlib
from collections.abc import Callable
from contextlib import ExitStack, closing
from types import FrameType
from typing import TypeVar

from station import __version__
from station.archive import Archive
from station.camera.port import Camera
from station.channel import Publisher
from station.classify.onnx import Classifier, RingNetwork
from station.cycle import Cycle, Listener
from station.errors import WeldgateError
from station.inspection import Inspector
from station.plc.modbus import ModbusServerLine
from station.records import Provenance
from station.settings import PylonSettings, Settings

log = logging.getLogger("weldgate")

Opened = TypeVar("Opened")


def make_camera(settings: Settings) -> Camera:
    """The camera that the settings name, not yet open."""
    if isinstance(settings.camera, PylonSettings):
        from station.camera.pylon import PylonCamera

        return PylonCamera(settings.camera)
    from station.camera.replay import ReplayCamera

    return ReplayCamera(settings.camera)


def load_inspector(settings: Settings) -> tuple[Inspector, Provenance]:
    """Inspector and what its verdicts come from. Raises ModelError."""
    ring_network = RingNetwork(settings.model.ring_path, settings.model.threads)
    classifier = Classifier(settings.model.path, settings.model.threads)
    inspector = Inspector(ring_network, classifier, settings.weld, settings.quality, settings.model)
    parts = (
        settings.model_dump_json(include={"camera", "weld", "quality"}),
        ring_network.file_hash,
        classifier.card.file_hash,
        str(inspector.thresholds),
    )
    provenance = Provenance(
        software=__version__,
        model_version=classifier.card.version,
        model_hash=classifier.card.file_hash,
        ring_model_hash=ring_network.file_hash,
        config_crc=zlib.crc32("".join(parts).encode()) & 0xFFFF,
        hole_threshold=inspector.thresholds.hole,
        missing_threshold=inspector.thresholds.missing_weld,
    )
    return inspector, provenance


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

        loaded = tried(lambda: load_inspector(settings))
        publisher = tried(lambda: stack.enter_context(closing(Publisher(settings.channel))))
        archive = tried(lambda: stack.enter_context(closing(Archive(settings.archive)))) if loaded else None
        if problems or loaded is None or publisher is None or archive is None:
            raise WeldgateError("; ".join(problems))
        line = ModbusServerLine(settings.plc)
        stack.callback(line.stop)
        line.start()
        inspector, provenance = loaded
        log.info("station up: model %s, PLC on port %d", provenance.model_version, line.port)
        cycle = Cycle(
            camera=make_camera(settings),
            origin=settings.camera.origin,
            line=line,
            inspector=inspector,
            archive=archive,
            provenance=provenance,
            listener=Listener(publisher.send, publisher.show),
            reconnect_s=settings.camera.reconnect_s if isinstance(settings.camera, PylonSettings) else 1.0,
        )
        cycle.run(stop)
