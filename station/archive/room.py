"""Free space of the archive's disk, as one of four levels."""

import shutil
import time
from enum import IntEnum

from station.settings.model import ArchiveSettings

CHECK_INTERVAL_S = 1.0
"""Minimum time between two measurements."""


class Room(IntEnum):
    """Level of free space; higher is better."""

    FULL = 0
    """Less than `min_free_mb`: the station stops, or continues without storing frames."""
    THIN = 1
    """Less than `thin_free_mb`: frames of OK parts are not stored."""
    LOW = 2
    """Less than `warn_free_mb`: the station warns."""
    ENOUGH = 3


class Disk:
    """The archive's disk; its free space is measured once a second at most."""

    def __init__(self, settings: ArchiveSettings) -> None:
        self._folder = settings.folder
        self._limits_mb = (settings.min_free_mb, settings.thin_free_mb, settings.warn_free_mb)
        self._checked_s = -CHECK_INTERVAL_S
        self._room = Room.FULL

    def room(self) -> Room:
        """Return the current level, or FULL if the free space cannot be measured."""
        now = time.monotonic()
        if now - self._checked_s >= CHECK_INTERVAL_S:
            self._checked_s = now
            try:
                free = shutil.disk_usage(self._folder).free
            except OSError:
                free = -1
            self._room = Room(sum(free >= limit * 1_000_000 for limit in self._limits_mb))
        return self._room
