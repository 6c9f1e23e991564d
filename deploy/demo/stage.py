"""Starts the station of the demo: engine with the emulated camera, and the window if there is a display."""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from rich.console import Console

from deploy.demo.station import SERIAL, running
from deploy.demo.summary import DemoPart
from station.errors import WeldgateError
from station.files.installation import room_command
from station.journal.commissioning import make_code
from station.settings.keys import keys_folder
from synth.camera.feed import Feed
from synth.errors import SynthError


@dataclass(frozen=True, slots=True)
class Stage:
    """A running station, and what lies in front of its camera."""

    folder: Path
    feed: Feed
    engine: "subprocess.Popen[bytes]"
    log: Path
    """Log of the engine."""

    def show(self, part: DemoPart) -> None:
        """Put a part in front of the camera. Raises SynthError if its image cannot be read."""
        image = cv2.imread(str(part.path), cv2.IMREAD_GRAYSCALE)
        if image is None:
            raise SynthError(f"{part.path}: not a readable image; restore it from the repository")
        self.feed.show(np.asarray(image, np.uint8))

    def check(self) -> None:
        """Raise WeldgateError if the engine has ended."""
        if self.engine.poll() is not None:
            raise WeldgateError(f"the engine stopped: {last_line(self.log)}")


@contextmanager
def staged(settings: str, window: bool, console: Console) -> Iterator[Stage]:
    """Run a station with these settings, and its window if `window`."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="weldgate-")))
        feed = Feed(folder / "feed", SERIAL)
        file, log = folder / "station.toml", folder / "engine.log"
        file.write_text(settings)
        environment = {**os.environ, **feed.environment}
        engine = stack.enter_context(
            running(
                [*room_command("station"), "engine", "-c", str(file)],
                environment,
                stack.enter_context(log.open("w")),
            )
        )
        if window:
            panel_log = folder / "panel.log"
            command = [*room_command("station"), "panel", "-c", str(file)]
            panel = stack.enter_context(
                running(command, dict(os.environ), stack.enter_context(panel_log.open("w")))
            )
            time.sleep(1.0)
            if panel.poll() is not None:
                reason = last_line(panel_log)
                console.print(f"[yellow]window could not be opened, continuing without it: {reason}[/]")
            else:
                console.print(login_hint(make_code(keys_folder(file))), highlight=False, soft_wrap=True)
        yield Stage(folder, feed, engine, log)


def login_hint(code: str) -> str:
    """Return how to log in at the window of this demo, whose keys end with it."""
    return f"to log in at the window: Setup, Login, code {code}, with a new name and a PIN of six digits"


def has_display() -> bool:
    """Return whether a window can be opened."""
    return sys.platform in ("win32", "darwin") or bool(
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    )


def last_line(log: Path) -> str:
    """Return the last line of a log that is not empty."""
    lines = [line for line in log.read_text(errors="replace").splitlines() if line.strip()]
    return lines[-1] if lines else "its log is empty"
