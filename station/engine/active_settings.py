"""The settings that the engine goes by: those of its start, until changed ones are wanted and accepted."""

from collections.abc import Callable
from dataclasses import dataclass

from station.camera.port import Camera
from station.errors import SettingsError
from station.inspection.loading import Loaded, prepare
from station.settings.camera import AnyCamera
from station.settings.model import Settings, for_recipe
from station.settings.section import Section


@dataclass(frozen=True, slots=True)
class Change:
    """Changed settings, ready to be used."""

    settings: Settings
    loaded: Loaded
    camera: Camera | None
    """If it is used otherwise."""


class Released:
    """Recipes are always loaded by the settings in use, so that one configuration names recipe and camera together."""

    def __init__(
        self, settings: Settings, again: Callable[[], Settings], make_camera: Callable[[AnyCamera], Camera]
    ) -> None:
        """`again` reads the file. Raises WeldgateError."""
        self._settings, self._again, self._make_camera = settings, again, make_camera

    @property
    def settings(self) -> Settings:
        """Settings in use."""
        return self._settings

    def prepare(self, number: int) -> Loaded:
        """A recipe. Raises WeldgateError."""
        return prepare(self._settings, number)

    def changed(self, number: int) -> Change:
        """Return the file as it is now, with a recipe loaded by it. Raises WeldgateError."""
        return self.prepared(self._again(), number)

    def prepared(self, new: Settings, number: int) -> Change:
        """Return other settings with a recipe loaded by them. Raises WeldgateError if they cannot be used.

        May be called from another thread than `accept`.
        """
        camera = None
        if new.camera.identity != self._settings.camera.identity:
            raise SettingsError("another camera cannot take over while the station runs; start it again")
        known = {1, *self._settings.recipes}
        for other in sorted({1, *new.recipes} - {number}):
            if other not in known or _judging(new, other) != _judging(self._settings, other):
                prepare(
                    new, other
                )  # or the station would not start next time, or refuse the recipe when the PLC wants it
        loaded = prepare(new, number)
        if new.camera != self._settings.camera:
            camera = self._make_camera(new.camera)
        return Change(new, loaded, camera)

    def camera(self) -> Camera:
        """Return the camera of the settings in use, not yet open."""
        return self._make_camera(self._settings.camera)

    def accept(self, change: Change) -> None:
        """From now on."""
        self._settings = change.settings


def _judging(settings: Settings, number: int) -> tuple[Section, ...]:
    chosen = for_recipe(settings, number)
    return chosen.weld, chosen.quality, chosen.model
