"""Recorded frames from a folder, each once, in the order of their names."""

from datetime import UTC, datetime

from station.domain import Frame, Origin
from station.errors import CameraLost, FrameDamaged, ImageError
from station.files.image import SUFFIXES, read_image
from station.settings.camera import ReplaySettings


class ReplayCamera:
    """A camera whose frames are image files; the PLC reads TEST for them."""

    def __init__(self, settings: ReplaySettings) -> None:
        self._folder = settings.folder
        self._files: list[str] | None = None

    def open(self) -> None:
        """List the folder; if opened again, continue at the next file. Raises CameraLost."""
        if self._files is not None:
            if not self._files:
                raise CameraLost(f"{self._folder}: no more images")
            return
        try:
            names = sorted(path.name for path in self._folder.iterdir() if path.suffix.lower() in SUFFIXES)
        except OSError as error:
            raise CameraLost(
                f"{self._folder}: cannot be read ({error.strerror}); set camera.folder"
            ) from None
        if not names:
            raise CameraLost(f"{self._folder}: no images in this folder; set camera.folder")
        self._files = names

    def grab(self, trigger_s: float) -> Frame:
        """Return the next file, whenever it was written.

        Raises FrameDamaged if it cannot be read, CameraLost after the last one.
        """
        if not self._files:
            raise CameraLost(f"{self._folder}: no more images")
        path = self._folder / self._files.pop(0)
        try:
            return Frame(read_image(path), datetime.now(UTC), path.name, Origin.REPLAY)
        except ImageError as error:
            raise FrameDamaged(str(error)) from None

    def adjust(self, exposure_us: float | None, gain_db: float | None) -> None:
        """Do nothing: recorded images are not affected."""

    def alive(self) -> bool:
        """Return whether an image is left."""
        return bool(self._files)

    def close(self) -> None:
        """Do nothing: no file is held open."""
