"""Recorded frames from a folder, in the order of their names, once each."""

from datetime import UTC, datetime

from station.domain import Frame, Origin
from station.errors import CameraLost, FrameDamaged, ImageError
from station.files.image import SUFFIXES, read_image
from station.settings.camera import ReplaySettings


class ReplayCamera:
    """A camera whose parts are files; the PLC reads TEST for them."""

    def __init__(self, settings: ReplaySettings) -> None:
        self._folder = settings.folder
        self._files: list[str] | None = None

    def open(self) -> None:
        """List the folder; goes on where it stood if opened again. Raises CameraLost."""
        if self._files is not None:
            if not self._files:
                raise CameraLost(f"{self._folder}: no more images")
            return
        try:
            names = sorted(p.name for p in self._folder.iterdir() if p.suffix.lower() in SUFFIXES)
        except OSError as error:
            raise CameraLost(
                f"{self._folder}: cannot be read ({error.strerror}); set camera.folder"
            ) from None
        if not names:
            raise CameraLost(f"{self._folder}: holds no images; set camera.folder")
        self._files = names

    def grab(self) -> Frame:
        """The next file. Raises FrameDamaged for an unreadable one, CameraLost after the last."""
        if not self._files:
            raise CameraLost(f"{self._folder}: no more images")
        path = self._folder / self._files.pop(0)
        try:
            return Frame(read_image(path), datetime.now(UTC), path.name, Origin.REPLAY)
        except ImageError as error:
            raise FrameDamaged(str(error)) from None

    def adjust(self, exposure_us: float | None, gain_db: float | None) -> None:
        """Recorded pictures stay as they are."""

    def alive(self) -> bool:
        """Whether an image is left."""
        return bool(self._files)

    def close(self) -> None:
        """Nothing is held open."""
