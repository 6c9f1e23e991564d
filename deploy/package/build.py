"""Puts all rooms into the one package `weldgate` of a wheel; an editable install uses the folders themselves.

setuptools loads this file, which pyproject.toml names, separately: it imports nothing of weldgate.
"""

from pathlib import Path

from setuptools.command.build_py import build_py
from setuptools.command.egg_info import egg_info

PRODUCT = "weldgate"


class BuildRooms(build_py):  # type: ignore[misc]  # setuptools has no types
    """Build step that copies station, synth, models and deploy to weldgate/station and so on."""

    packages: list[str]
    package_dir: dict[str, str]
    package_data: dict[str, list[str]]

    def finalize_options(self) -> None:
        """Set the name of each package in the wheel."""
        super().finalize_options()
        if self.editable_mode or not self.packages:
            return
        rooms = [name for name in self.packages if name != PRODUCT]
        self.packages = [PRODUCT, *(f"{PRODUCT}.{name}" for name in rooms)]
        self.package_dir = self.package_dir | {f"{PRODUCT}.{name}": name for name in rooms if "." not in name}
        self.package_data = {f"{PRODUCT}.{name}": patterns for name, patterns in self.package_data.items()}


class Metadata(egg_info):  # type: ignore[misc]  # setuptools has no types
    """Build step that omits the list of top-level names, which would contain the folders' names."""

    def run(self) -> None:
        """Write the metadata without the list of top-level names."""
        super().run()
        Path(self.egg_info, "top_level.txt").unlink(missing_ok=True)
