"""Uses changed settings at a moment with no part in work: device first, then the file, then the verdicts."""

import logging
from collections.abc import Callable

from station.camera.reconnecting import ReconnectingCamera
from station.channel.requests import FAULT
from station.engine.active_settings import Released
from station.engine.orders import UseSettings
from station.errors import SettingsError, WeldgateError
from station.inspection.loading import Loaded, prepare

log = logging.getLogger("weldgate.settings")

RELOAD_REFUSED = "the settings file cannot be used: see the engine's log; the settings before stay in use"
CAMERA_REFUSES = "the camera cannot be used with these values: see the engine's log"


def use_settings(
    order: UseSettings,
    released: Released,
    camera: ReconnectingCamera,
    number: int,
    use: Callable[[Loaded], None],
) -> None:
    """Carry out the order, or leave settings, file and camera as they were; answer its ticket either way.

    `number`: of the recipe in use now; `use` judges by a loaded recipe from then on.
    """
    refusal = FAULT
    try:
        change = order.change
        loaded = change.loaded if change.loaded.number == number else prepare(change.settings, number)
        if change.camera is not None and not camera.exchange(change.camera):
            raise SettingsError(CAMERA_REFUSES)
        try:
            order.replace_file()
        except SettingsError:
            if change.camera is not None:
                camera.exchange(released.camera())
            raise
        released.accept(change)
    except WeldgateError as error:
        log.error("changed settings are not used: %s", error)
        refusal = str(error)
    except Exception:  # the station continues with the settings that it has
        log.exception("changed settings are not used")
    else:
        refusal = ""
        use(loaded)
    finally:
        order.ticket.answer(refusal)
