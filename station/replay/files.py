"""Which files are to be judged, and what an archive already says of them."""

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
    """One image, and the row of the archive that it belongs to, if any."""

    name: str
    """Unique, relative to what the paths have in common."""
    path: Path
    row: Row | None = None


def sources(paths: Iterable[Path]) -> list[Source]:
    """Images among `paths`; folders are searched all the way down in the order of names, links to folders are not followed.

    An archive gives the frames of its records. A file that is found twice is judged once. Raises ImageError if a path does not exist or
    no image is found, RecordError.
    """
    found: dict[Path, tuple[Path, Row | None]] = {}
    for path in paths:
        if (path / NAME).is_file():
            for row in find(path):
                if row.frame_file is not None and row.frame_state == "kept":
                    found.setdefault((path / row.frame_file).resolve(), (path / row.frame_file, row))
        elif path.is_dir():
            for file in _below(path):
                found.setdefault(_real(file), (file, None))
        elif path.exists() or path.is_symlink():
            found.setdefault(_real(path), (path, None))
        else:
            raise ImageError(f"{path}: no such file or folder")
    if not found:
        raise ImageError(f"{', '.join(str(p) for p in paths)}: no images found; PNG, BMP, TIFF and JPEG are read")
    base = Path(os.path.commonpath([path.absolute().parent for path, _ in found.values()]))
    return [Source(path.absolute().relative_to(base).as_posix(), path, row) for path, row in found.values()]


def _below(folder: Path) -> Iterator[Path]:
    for place, folders, files in os.walk(folder):
        folders.sort()
        yield from (Path(place) / name for name in sorted(files) if Path(name).suffix.lower() in SUFFIXES)


def _real(path: Path) -> Path:
    try:
        return path.resolve()
    except (OSError, RuntimeError):  # a loop of links: reading it says so
        return path.absolute()
