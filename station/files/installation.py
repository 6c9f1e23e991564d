"""Where this installation lies, and how to start one of its rooms in a process of its own, in any folder and with any path.

Run as a file it is that process: `python -P station/files/installation.py ROOM ARGUMENT...`
"""

import runpy
import sys
from pathlib import Path

ROOMS_FOLDER = Path(__file__).resolve().parents[2]
"""Folder of station, synth, models and deploy: the checkout, or the installed package."""
SHIPPED_NETWORKS = ROOMS_FOLDER / "models" / "shipped"
"""Folder of the networks that come with weldgate."""


def room_command(room: str) -> list[str]:
    """Return the beginning of a command line that runs a room such as "station"; its arguments follow."""
    return [sys.executable, "-P", str(Path(__file__).resolve()), room]


if __name__ == "__main__":
    sys.path.insert(0, str(ROOMS_FOLDER))
    sys.argv = sys.argv[1:]
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
