"""Keeps the features of the cameras in the archive: each set once, under the hash that the records name."""

import hashlib
import logging
from pathlib import Path

from station.files.durable import sync_folder, write_whole

log = logging.getLogger("weldgate.archive")

FOLDER = "cameras"
"""Folder of the sets, inside the archive."""


class CameraFeatures:
    """The sets that this engine has seen. Use from one thread."""

    def __init__(self, folder: Path) -> None:
        """`folder`: the archive; nothing is written yet."""
        self._folder = folder / FOLDER
        self._known: dict[str, str] = {}

    def keep(self, features: str) -> str:
        """Write a set durably unless it is there; return its SHA-256. Raises OSError."""
        known = self._known.get(features)
        if known is not None:
            return known
        text = features.encode()
        sha256 = hashlib.sha256(text).hexdigest()
        path = self._folder / f"{sha256}.txt"
        if not path.is_file():
            if not self._folder.is_dir():
                self._folder.mkdir()
                sync_folder(self._folder.parent)
            write_whole(path, text, durable=True)
            sync_folder(self._folder)
            log.info("the camera has other features than before: %s", path)
        self._known[features] = sha256
        return sha256
