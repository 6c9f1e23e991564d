"""Folder of the channel's Unix sockets: the system lets in only the accounts that its mode admits.

The folder is the lock of the channel. Both ends refuse a folder that everybody may enter or exchange.
"""

import os
import stat
from dataclasses import dataclass
from pathlib import Path

from station.errors import LineError
from station.files.lock import hold

MAX_PATH_BYTES = 103
"""Maximum length of the path of a Unix socket, less one byte on some systems."""
FOLDER_MODE = 0o700
"""Mode of a folder that is made: only the account of the engine may enter."""
SOCKET_MODE = 0o666
"""Mode of a socket: who may use it is decided by the folder."""
OTHERS_ENTER, OTHERS_WRITE = 0o007, 0o002


@dataclass(frozen=True, slots=True)
class Peer:
    """Account and process at the other end of a connection, as the system reports them."""

    account: int
    """User id."""
    process: int

    def __str__(self) -> str:
        return f"user id {self.account}, process {self.process}"


def socket_path(folder: Path, name: str) -> Path:
    """Return the path of a socket in the folder. Raises LineError if it is too long."""
    path = folder.resolve() / name
    if len(os.fsencode(path)) > MAX_PATH_BYTES:
        raise LineError(
            f"{path}: longer than the {MAX_PATH_BYTES} bytes that the path of a socket may have; "
            "set channel.folder to a folder with a shorter path"
        )
    return path


def address(folder: Path, name: str) -> str:
    """Return the address of a socket for ZeroMQ. Raises LineError if its path is too long."""
    return f"ipc://{socket_path(folder, name)}"


def make_folder(folder: Path) -> None:
    """Make the folder for the engine unless it is there. Raises LineError if it cannot be used safely."""
    try:
        folder.mkdir(mode=FOLDER_MODE, exist_ok=True)
        owner = folder.stat().st_uid
    except OSError as error:
        raise LineError(
            f"the channel's folder {folder} cannot be made ({error.strerror}); set channel.folder to a "
            "folder that the engine may make, such as one under /run"
        ) from None
    if owner not in (0, os.geteuid()):
        raise LineError(f"the channel's folder {folder} belongs to another account; set channel.folder")
    check_folder(folder)


def check_folder(folder: Path) -> None:
    """Raise LineError unless this account may use the folder and others may neither enter nor exchange it.

    A folder that does not exist is accepted: the engine makes it when it starts.
    """
    place = folder.resolve()
    try:
        mode = place.stat().st_mode
        if not stat.S_ISDIR(mode):
            raise LineError(f"the channel's folder {folder} is not a folder; set channel.folder")
        exchangeable = [other for other in place.parents if _everybody_may_exchange(other)]
    except FileNotFoundError:
        return
    except OSError as error:
        raise LineError(f"the channel's folder {folder} cannot be read ({error.strerror})") from None
    if mode & OTHERS_ENTER:
        raise LineError(
            f"every account of this machine may enter the channel's folder {folder}; run 'chmod o-rwx' on it"
        )
    if exchangeable:
        raise LineError(
            f"every account of this machine may exchange the channel's folder {folder}, because all may "
            f"write in {exchangeable[0]}; run 'chmod o-w' there, or set channel.folder"
        )
    if not os.access(place, os.X_OK):
        raise LineError(
            f"this account may not use the channel: it must own {folder}, or belong to its group, and the "
            "group must be allowed to enter"
        )


def _everybody_may_exchange(folder: Path) -> bool:
    mode = folder.stat().st_mode
    return bool(mode & OTHERS_WRITE) and not mode & stat.S_ISVTX


class Claim:
    """Claim of one engine to a socket; another engine would take its windows over without a word."""

    def __init__(self, folder: Path, name: str) -> None:
        """Make the folder and take the claim. Raises LineError."""
        make_folder(folder)
        try:
            self._lock = hold(folder.resolve() / f"{name}.lock")
        except BlockingIOError:
            raise LineError(
                f"another engine uses the channel's folder {folder}; stop it, or set channel.folder"
            ) from None
        except OSError as error:
            raise LineError(f"the channel's folder {folder} cannot be used ({error.strerror})") from None

    def release(self) -> None:
        """Give the claim up."""
        self._lock.release()
