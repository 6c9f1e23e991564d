"""Serves images to pylon's emulated camera, a new one at each trigger, for an unmodified station.

A folder of two links to one "current" BMP is read again from disk at each frame; a settings file named by
PYLON_CAMEMU_PFS_PATH (undocumented: pypylon is pinned, a test proves it) points the emulator at the folder.
"""

import os
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.errors import SynthError

HEADER = """# {05D8C294-F295-4dfb-9D01-096BD04049F4}
# GenApi persistence file (version 3.5.0)
# Device = Basler::BaslerCamEmu -- Basler Cam Emu interface \
-- Device version = 1.0.1 -- Product GUID = B97DE549-CB9A-44f8-937D-64C48BDECFA3 \
-- Product version GUID = A2DCDE14-73E4-408a-AFA8-81852ECB5D9A
"""


class Feed:
    """The image in front of one emulated camera. Give `environment` to the station's process."""

    def __init__(self, folder: Path, serial: str = "0815-0000") -> None:
        """Lay out `folder` (created; must not be in use by another feed)."""
        self._current = folder / "current.bmp"
        self._next = folder / "next.bmp"
        slots, profile = folder / "slots", folder / "profile"
        try:
            slots.mkdir(parents=True, exist_ok=True)
            profile.mkdir(exist_ok=True)
            for index in (0, 1):
                link = slots / f"{index}.bmp"
                link.unlink(missing_ok=True)
                link.symlink_to(self._current.resolve())
        except OSError as error:
            raise SynthError(f"{folder}: the feed cannot be laid out there: {error}") from None
        size = ("WidthMax\t4200", "HeightMax\t2160")
        lines = (*size, "TestImageSelector\tOff", f"ImageFilename\t{slots.resolve()}", "ImageFileMode\tOn")
        (profile / f"CamEmu_{serial}.pfs").write_text(HEADER + "\n".join(lines) + "\n")
        self.environment = {"PYLON_CAMEMU": "1", "PYLON_CAMEMU_PFS_PATH": str(profile.resolve())}

    def show(self, image: NDArray[np.uint8]) -> None:
        """Put `image` (H, W) uint8 in front of the camera; never half of one."""
        if not cv2.imwrite(str(self._next), image):
            raise SynthError(f"{self._next}: could not be written; is the disk full?")
        os.replace(self._next, self._current)

    def withdraw(self) -> None:
        """Remove the image: the next grab fails."""
        self._current.unlink(missing_ok=True)
