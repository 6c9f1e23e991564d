"""Reads a settings file for the installer, which asks the new version; exit code 2 if the file is refused."""

import sys
from pathlib import Path

from station.errors import WeldgateError
from station.settings import adjustments
from station.settings.file import load


def main() -> int:
    """Read the settings file named on the command line and the changes made at the station."""
    path = Path(sys.argv[1])
    try:
        load(path)
        adjustments.read(path)
    except (WeldgateError, OSError) as error:
        print(f"weldgate: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
