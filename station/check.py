"""What is wrong with this station, and what to do: one line for each thing looked at."""

import socket
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

from station.archive import Archive
from station.errors import WeldgateError
from station.settings import Settings, load
from station.startup import load_inspector, make_camera


def check(path: Path) -> Iterator[tuple[str, str | None]]:
    """(name, None) for each thing in order, (name, what is wrong) for each that is not."""
    try:
        settings = load(path)
    except WeldgateError as error:
        yield "settings", str(error)
        return
    yield "settings", None
    for name, look in (("model", _model), ("archive", _archive), ("camera", _camera), ("PLC port", _port)):
        try:
            look(settings)
        except WeldgateError as error:
            yield name, str(error)
        else:
            yield name, None


def _model(settings: Settings) -> None:
    load_inspector(settings)


def _archive(settings: Settings) -> None:
    archive = Archive(settings.archive)
    try:
        if not archive.has_room():
            raise WeldgateError(
                f"{settings.archive.folder}: less than {settings.archive.min_free_mb} MB free; make room or set archive.min_free_mb"
            )
    finally:
        archive.close()


def _camera(settings: Settings) -> None:
    camera = make_camera(settings)
    try:
        camera.open()
    finally:
        camera.close()


def _port(settings: Settings) -> None:
    with closing(socket.socket()) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((settings.plc.host, settings.plc.port))
        except OSError as error:
            raise WeldgateError(
                f"{settings.plc.host}:{settings.plc.port} is not free ({error.strerror}); is the engine running? else set plc.port"
            ) from None
