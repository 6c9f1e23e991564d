"""`weldgate check`: checks the parts of a station one after the other."""

import socket
import time
from collections.abc import Iterator
from contextlib import closing, suppress
from functools import partial
from pathlib import Path

from station.archive.room import Room
from station.archive.writer import Archive
from station.camera.choose import make_camera
from station.domain import TRAINED_UM_PER_PX
from station.engine.archive_identity import check_archive
from station.errors import WeldgateError
from station.inspection.loading import OWN_FRAME, prepare
from station.plc.line import make_line
from station.plc.wire.access import open_to_all
from station.settings.file import load
from station.settings.model import Settings, for_recipe
from station.settings.view import check_view


def check(path: Path) -> Iterator[tuple[str, str | None]]:
    """Yield (name, None) for each part of the station that works, (name, problem) for each that does not."""
    try:
        settings = load(path)
    except WeldgateError as error:
        yield "settings", str(error)
        return
    yield "settings", None
    yield _scale(settings), None
    archive = partial(_archive, path)
    for name, probe in (("model", _model), ("archive", archive), ("camera", _camera), ("PLC", _plc)):
        try:
            probe(settings)
        except WeldgateError as error:
            yield name, str(error)
        else:
            yield name, None
    plc = settings.plc
    if plc.mode == "server" and (said := open_to_all(plc.host, plc.allow)):
        yield said, None


def switched_off(path: Path) -> list[str]:
    """Return the checks of the station itself that are off, with what to set. Raises SettingsError."""
    settings = load(path)
    off = []
    for number in sorted({1, *settings.recipes}):
        with suppress(WeldgateError):  # reported as a problem
            if prepare(settings, number).self_test is None:
                off.append(
                    f"self-test of recipe {number}: the shipped frame does not fit the weld; {OWN_FRAME}"
                )
    if not settings.golden.masters:
        off.append("master check: no masters; name them under [golden.masters]")
    elif settings.golden.due_h is None:
        off.append("masters are never due; set golden.due_h")
    if settings.model.reference_path is None:
        off.append("drift is not monitored; set model.reference_path (weldgate-models first-day writes it)")
    return off


def _scale(settings: Settings) -> str:
    """Return the scale of the images of all recipes, next to what the networks are trained for."""
    recipes = sorted({1, *settings.recipes})
    scales = sorted({for_recipe(settings, number).weld.um_per_px for number in recipes})
    low, high = TRAINED_UM_PER_PX
    return f"scale {' and '.join(f'{scale:g}' for scale in scales)} µm/px, trained for {low:g} to {high:g}"


def _model(settings: Settings) -> None:
    for number in sorted({1, *settings.recipes}):
        prepare(settings, number)


def _archive(path: Path, settings: Settings) -> None:
    check_archive(path, settings.archive.folder)
    archive = Archive(settings.archive)
    try:
        room = archive.room()
        if room is not Room.ENOUGH:
            limit = (
                settings.archive.min_free_mb,
                settings.archive.thin_free_mb,
                settings.archive.warn_free_mb,
            )[room]
            raise WeldgateError(
                f"{settings.archive.folder}: less than {limit} MB free; free some space, "
                "or shorten the retention under archive.keep"
            )
    finally:
        archive.close()


def _camera(settings: Settings) -> None:
    camera = make_camera(settings.camera)
    try:
        camera.open()
        if settings.camera.size_px is None:
            height_px, width_px = camera.grab(time.monotonic()).image.shape
            check_view(settings, (width_px, height_px))
    finally:
        camera.close()


def _plc(settings: Settings) -> None:
    make_line(settings.plc)  # certificates
    if settings.plc.mode == "client":
        _reached(settings.plc.host, settings.plc.port)
    else:
        _free(settings)


def _reached(host: str, port: int) -> None:
    try:
        socket.create_connection((host, port), timeout=2).close()
    except OSError as error:
        raise WeldgateError(
            f"PLC {host}:{port} cannot be reached ({error}); check address, cable and firewall, "
            "or set another plc.host"
        ) from None


def _free(settings: Settings) -> None:
    with closing(socket.socket()) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((settings.plc.host, settings.plc.port))
        except OSError as error:
            raise WeldgateError(
                f"{settings.plc.host}:{settings.plc.port} is in use ({error.strerror}); stop the engine "
                "if it is running, or set another plc.port"
            ) from None
