"""Folder of this installation, and the command line that runs one of its rooms in a separate process.

The command works in any folder and with any Python path: it runs this file, which starts the room:
`python -P station/files/installation.py ROOM ARGUMENT...`
"""

import runpy
import sys
from pathlib import Path

ROOMS_FOLDER = Path(__file__).resolve().parents[2]
"""Folder that contains station, synth, models and deploy: the checkout, or the installed package."""
SHIPPED_NETWORKS = ROOMS_FOLDER / "models" / "shipped"
"""Folder of the networks that are shipped with weldgate."""
SHIPPED_GOOD_FRAME = ROOMS_FOLDER / "deploy" / "frames" / "part_03000055.png"
"""Frame of a good part, rendered for the default weld and scale."""


def room_command(room: str) -> list[str]:
    """Return the command line that runs a room such as "station"; append the arguments of the room."""
    return [sys.executable, "-P", str(Path(__file__).resolve()), room]


if __name__ == "__main__":
    sys.path.insert(0, str(ROOMS_FOLDER))
    sys.argv = sys.argv[1:]
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
