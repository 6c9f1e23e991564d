"""Commands that start a room of this installation in a process of its own, in any folder and with any path.

Run as a file it is that process: `python -P station/process.py ROOM ARGUMENT...`
"""

import runpy
import sys
from pathlib import Path

ROOMS_FOLDER = Path(__file__).resolve().parent.parent
"""Folder of station, synth, models and deploy: the checkout, or the installed package."""


def room_command(room: str) -> list[str]:
    """Return the beginning of a command line that runs a room such as "station"; its arguments follow."""
    return [sys.executable, "-P", str(Path(__file__).resolve()), room]


if __name__ == "__main__":
    sys.path.insert(0, str(ROOMS_FOLDER))
    sys.argv = sys.argv[1:]
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
