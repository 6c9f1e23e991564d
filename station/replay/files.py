"""Finds the images to judge, and the records of those that come from an archive."""

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from station.archive.reader import Row, find
from station.archive.schema import NAME
from station.errors import ImageError
from station.files.image import SUFFIXES


@dataclass(frozen=True, slots=True)
class Source:
    """One image to judge."""

    name: str
    """Unique name: the path relative to the folder that all images have in common."""
    path: Path
    archive: Path | None = None
    """Folder of the archive; None, like `row`, if the image does not come from an archive."""
    row: Row | None = None


def sources(paths: Iterable[Path]) -> list[Source]:
    """Return the images among `paths`.

    Folders are searched recursively in the order of names; hidden names and links to folders are passed
    over. For an archive,
    the frames of its records are returned. A file that is found twice is judged once. Raises ImageError if a
    path does not exist or no image is found, RecordError if an archive cannot be read.
    """
    found: dict[Path, tuple[Path, Path | None, Row | None]] = {}
    for path in paths:
        if (path / NAME).is_file():
            for row in find(path):
                if row.frame_file is not None and row.frame_state == "kept":
                    found.setdefault((path / row.frame_file).resolve(), (path / row.frame_file, path, row))
        elif path.is_dir():
            for file in _below(path):
                found.setdefault(_real(file), (file, None, None))
        elif path.exists() or path.is_symlink():
            found.setdefault(_real(path), (path, None, None))
        else:
            raise ImageError(f"no such file or folder: {path}")
    if not found:
        places = ", ".join(str(path) for path in paths)
        raise ImageError(f"no images found: {places}. Name PNG, BMP, TIFF or JPEG files or their folders")
    base = Path(os.path.commonpath([path.absolute().parent for path, _, _ in found.values()]))
    names = (path.absolute().relative_to(base).as_posix() for path, _, _ in found.values())
    return [Source(name, *place) for name, place in zip(names, found.values(), strict=True)]


def _below(folder: Path) -> Iterator[Path]:
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if not _is_hidden(name))
        images = sorted(name for name in files if Path(name).suffix.lower() in SUFFIXES)
        yield from (Path(place) / name for name in images if not _is_hidden(name))


def _is_hidden(name: str) -> bool:
    """Return whether a program made this for itself: companions of a Mac, checkpoints, a NAS's thumbnails."""
    return name.startswith(".") or name == "@eaDir"


def _real(path: Path) -> Path:
    try:
        return path.resolve()
    except (OSError, RuntimeError):  # a loop of links, which is reported when the file is read
        return path.absolute()
