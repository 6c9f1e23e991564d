"""The active settings of the engine: those of its start, until others are requested and accepted."""

from collections.abc import Callable
from dataclasses import dataclass

from station.camera.port import Camera
from station.errors import SettingsError
from station.inspection.loading import Loaded, prepare
from station.settings.camera import AnyCamera
from station.settings.differences import need_restart
from station.settings.model import Settings, for_recipe
from station.settings.section import Section


@dataclass(frozen=True, slots=True)
class PreparedSettings:
    """Settings that have been checked and loaded, ready to become active."""

    settings: Settings
    loaded: Loaded
    camera: Camera | None
    """New camera, not yet open; None if the camera's settings are unchanged."""


class ActiveSettings:
    """The active settings; recipes are always loaded with them, so that recipe and camera belong together."""

    def __init__(
        self, settings: Settings, read: Callable[[], Settings], make_camera: Callable[[AnyCamera], Camera]
    ) -> None:
        """`read` returns the settings in the file. Raises WeldgateError."""
        self._settings, self._read, self._make_camera = settings, read, make_camera

    @property
    def settings(self) -> Settings:
        """Active settings."""
        return self._settings

    def load_recipe(self, number: int) -> Loaded:
        """Return a recipe loaded with the active settings. Raises WeldgateError."""
        return prepare(self._settings, number)

    def prepare_file(self, number: int) -> PreparedSettings:
        """Return the settings that the file holds now, with a recipe loaded. Raises WeldgateError."""
        return self.prepare(self._read(), number)

    def prepare(self, new: Settings, number: int) -> PreparedSettings:
        """Return other settings with a recipe loaded. Raises WeldgateError if they cannot be used.

        May be called from another thread than `activate`.
        """
        camera = None
        if new.camera.identity != self._settings.camera.identity:
            raise SettingsError("the camera cannot be exchanged while the station runs; restart the station")
        if fixed := need_restart(self._settings, new):
            raise SettingsError(
                f"{', '.join(fixed)}: changed in the settings file, and used only after a restart. "
                "Restart the station, or set the previous value; nothing was changed."
            )
        known = {1, *self._settings.recipes}
        for other in sorted({1, *new.recipes} - {number}):
            if other not in known or _judging(new, other) != _judging(self._settings, other):
                prepare(new, other)  # refuse now what the next start or the PLC's next command would refuse
        loaded = prepare(new, number)
        if new.camera != self._settings.camera:
            camera = self._make_camera(new.camera)
        return PreparedSettings(new, loaded, camera)

    def make_camera(self) -> Camera:
        """Return the camera of the active settings, not yet open."""
        return self._make_camera(self._settings.camera)

    def activate(self, prepared: PreparedSettings) -> None:
        """Make prepared settings the active ones."""
        self._settings = prepared.settings


def _judging(settings: Settings, number: int) -> tuple[Section, ...]:
    """Return the sections by which a recipe judges."""
    chosen = for_recipe(settings, number)
    return chosen.weld, chosen.quality, chosen.model
