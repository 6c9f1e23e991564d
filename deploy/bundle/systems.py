"""Systems that a bundle can be built for, and what it needs of them."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class System:
    """One supported system: the version of its Python and of its C library."""

    python: str
    glibc_minor: int


SYSTEMS: Mapping[str, System] = {
    "debian-12": System("3.11", 36),
    "debian-13": System("3.13", 41),
    "ubuntu-24.04": System("3.12", 39),
}
"""Supported systems by ID and VERSION_ID of their os-release; all are x86_64. install.sh names them too."""

LIBRARIES = (
    ("libEGL.so.1", "libegl1"),
    ("libGL.so.1", "libgl1"),
    ("libglib-2.0.so.0", "libglib2.0-0"),
    ("libfontconfig.so.1", "libfontconfig1"),
    ("libdbus-1.so.3", "libdbus-1-3"),
    ("libX11-xcb.so.1", "libx11-xcb1"),
    ("libxcb-cursor.so.0", "libxcb-cursor0"),
    ("libxcb-icccm.so.4", "libxcb-icccm4"),
    ("libxcb-image.so.0", "libxcb-image0"),
    ("libxcb-keysyms.so.1", "libxcb-keysyms1"),
    ("libxcb-randr.so.0", "libxcb-randr0"),
    ("libxcb-render-util.so.0", "libxcb-render-util0"),
    ("libxcb-shape.so.0", "libxcb-shape0"),
    ("libxcb-sync.so.1", "libxcb-sync1"),
    ("libxcb-xfixes.so.0", "libxcb-xfixes0"),
    ("libxcb-xkb.so.1", "libxcb-xkb1"),
    ("libxkbcommon-x11.so.0", "libxkbcommon-x11-0"),
)
"""System libraries of the station, each with its package; deploy/system.sh has also those of the renderer."""


def platforms(system: System) -> list[str]:
    """Return the platform tags of wheels that run on a system, newest first."""
    names = [f"manylinux_2_{minor}_x86_64" for minor in range(system.glibc_minor, 4, -1)]
    return [*names, "manylinux2014_x86_64", "manylinux2010_x86_64", "linux_x86_64"]
