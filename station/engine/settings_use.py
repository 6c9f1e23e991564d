"""Makes changed settings active at a moment without a part in progress: first the camera, then the file."""

import logging
from collections.abc import Callable

from station.camera.reconnecting import ReconnectingCamera
from station.channel.requests import FAULT
from station.engine.active_settings import ActiveSettings
from station.engine.orders import UseSettings
from station.errors import SettingsError, WeldgateError
from station.inspection.loading import Loaded, prepare

log = logging.getLogger("weldgate.settings")

RELOAD_REFUSED = "the settings file cannot be used: see the engine's log. The previous settings stay active."
"""Refusal of a settings file."""
CAMERA_REFUSES = "the camera cannot be used with these values: see the engine's log"
"""Refusal of settings with which the camera could not be opened."""


def use_settings(
    order: UseSettings,
    *,
    active: ActiveSettings,
    camera: ReconnectingCamera,
    number: int,
    use: Callable[[Loaded], None],
) -> None:
    """Carry out the order, or leave settings, file and camera as they were; answer its ticket either way.

    `number`: number of the active recipe; `use` makes a loaded recipe the active one.
    """
    refusal = FAULT
    try:
        prepared = order.prepared
        loaded = prepared.loaded
        if loaded.number != number:
            loaded = prepare(prepared.settings, number)
        if prepared.camera is not None and not camera.replace(prepared.camera):
            raise SettingsError(CAMERA_REFUSES)
        try:
            order.replace_file()
        except SettingsError:
            if prepared.camera is not None:
                camera.replace(active.make_camera())
            raise
        active.activate(prepared)
    except WeldgateError as error:
        log.error("changed settings are not used: %s", error)
        refusal = str(error)
    except Exception:  # the station continues with its present settings
        log.exception("changed settings are not used")
    else:
        refusal = ""
        use(loaded)
    finally:
        order.ticket.answer(refusal)
