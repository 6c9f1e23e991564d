"""How much room the disk has, in three levels."""

import shutil
import time
from enum import IntEnum

from station.settings.model import ArchiveSettings

LOOK_S = 1.0


class Room(IntEnum):
    """What is left, and what follows from it."""

    FULL = 0
    """Below `min_free_mb`: stop, or go on without pictures."""
    THIN = 1
    """Below `thin_free_mb`: pictures of OK parts are left out."""
    LOW = 2
    """Below `warn_free_mb`: somebody should look."""
    ENOUGH = 3


class Disk:
    """Looks once a second at the most."""

    def __init__(self, settings: ArchiveSettings) -> None:
        self._folder = settings.folder
        self._limits_mb = (settings.min_free_mb, settings.thin_free_mb, settings.warn_free_mb)
        self._looked_s = -LOOK_S
        self._room = Room.FULL

    def room(self) -> Room:
        """The level now; FULL if it cannot be told."""
        now = time.monotonic()
        if now - self._looked_s >= LOOK_S:
            self._looked_s = now
            try:
                free = shutil.disk_usage(self._folder).free
            except OSError:
                free = -1
            self._room = Room(sum(free >= limit * 1_000_000 for limit in self._limits_mb))
        return self._room
