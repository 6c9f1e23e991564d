"""Finds out where a named output goes: into a file that is replaced, or into something that is written to.

Links are followed. Devices, FIFOs and open descriptors (`/dev/stdout`, `/dev/fd/3`) are written to. A regular
file is replaced as a whole where its mode and owner can be kept, otherwise it is written in place.
"""

import os
import shutil
import stat
import sys
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

STANDARD_OUTPUT = Path("/dev/stdout")
"""Path that a named output `-` stands for."""
MAX_LINKS = 40
"""Number of links after which a path is taken for a loop, as in the kernel."""


@dataclass(frozen=True, slots=True)
class Destination:
    """Place of a named output."""

    path: Path
    """Path with all links followed."""
    descriptor: int | None = None
    """Descriptor of this process that the path names; None if it names a file."""
    status: os.stat_result | None = None
    """Status of what is there now; None if nothing is there."""

    @property
    def is_replaceable(self) -> bool:
        """True if nothing is there, or a regular file that can be replaced with its mode and owner kept."""
        if self.descriptor is not None or not os.access(self.path.parent, os.W_OK):
            return self.descriptor is None and self.status is None
        if self.status is None:
            return True
        mine = not hasattr(os, "geteuid") or os.geteuid() in (0, self.status.st_uid)
        return stat.S_ISREG(self.status.st_mode) and mine and _in_my_groups(self.status.st_gid)

    @property
    def is_kept(self) -> bool:
        """True if what is there now would be lost: a regular file, or a folder."""
        mode = 0 if self.status is None else self.status.st_mode
        return stat.S_ISREG(mode) or stat.S_ISDIR(mode)

    def check(self) -> None:
        """Raise OSError if the output cannot be written: a folder, a protected file, no such folder."""
        if self.descriptor is not None:
            os.fstat(self.descriptor)
        elif self.status is None:
            self.path.parent.stat()
            if not os.access(self.path.parent, os.W_OK):
                raise PermissionError(13, "Permission denied", str(self.path))
        elif stat.S_ISDIR(self.status.st_mode):
            raise IsADirectoryError(21, "Is a directory", str(self.path))
        elif not os.access(self.path, os.W_OK):
            raise PermissionError(13, "Permission denied", str(self.path))

    def open(self) -> BinaryIO:
        """Open what is there for writing; a regular file is emptied. Raises OSError."""
        if self.descriptor is None:
            return os.fdopen(os.open(self.path, os.O_WRONLY | os.O_TRUNC), "wb")
        return os.fdopen(os.dup(self.descriptor), "wb")

    def fill(self, source: Path) -> None:
        """Write the content of a file into what is there. Raises OSError."""
        with source.open("rb") as content, self.open() as output:
            shutil.copyfileobj(content, output)

    def give_mode_and_owner(self, replacement: Path) -> None:
        """Give a file that will replace this one its owner and mode. Raises OSError."""
        if self.status is None or os.name != "posix":
            return
        made = replacement.stat()
        if (made.st_uid, made.st_gid) != (self.status.st_uid, self.status.st_gid):
            os.chown(replacement, self.status.st_uid, self.status.st_gid)
        replacement.chmod(stat.S_IMODE(self.status.st_mode))


def find_destination(path: Path) -> Destination:
    """Return where an output of this name goes. Raises OSError for a loop of links."""
    if path == STANDARD_OUTPUT:
        return Destination(path, 1)
    for _ in range(MAX_LINKS):
        folder = Path(os.path.realpath(path.parent))
        if path.name.isdecimal() and _is_of_descriptors(folder):
            return Destination(path, int(path.name))
        if not path.is_symlink():
            break
        path = path.parent / path.readlink()
    else:
        raise OSError(40, "Too many levels of symbolic links", str(path))
    real = folder / path.name
    try:
        return Destination(real, status=real.stat())
    except FileNotFoundError:
        return Destination(real)


def output_path(text: str) -> Path:
    """Return the path of an output that a person names; `-` is standard output."""
    return STANDARD_OUTPUT if text == "-" else Path(text)


@contextmanager
def standard_output_free(values: Iterable[object]) -> Iterator[None]:
    """Print to standard error while one of these values of options is an output to standard output.

    The output then has standard output for itself.
    """
    paths = [value for value in values if isinstance(value, Path)]
    with ExitStack() as stack:
        if any(_is_standard_output(path) for path in paths):
            sys.stdout.flush()
            stack.enter_context(redirect_stdout(sys.stderr))
        yield


def _is_standard_output(path: Path) -> bool:
    try:
        return find_destination(path).descriptor == 1
    except OSError:  # reported where the path is used
        return False


def _is_of_descriptors(folder: Path) -> bool:
    """Return whether the entries of a folder are the open descriptors of this process."""
    parts = folder.parts
    return parts[:3] in (("/", "proc", str(os.getpid())), ("/", "dev", "fd")) and parts[-1] == "fd"


def _in_my_groups(group: int) -> bool:
    if not hasattr(os, "getgroups"):
        return True
    return os.geteuid() == 0 or group in (os.getegid(), *os.getgroups())
