"""`weldgate commission`: makes what an installation needs before the first person can log in."""

from pathlib import Path

from station.journal.commissioning import make_code
from station.settings.file import load
from station.settings.keys import keys_folder


def commission(settings: Path) -> int:
    """Make a commissioning code and print it; return the exit code. Raises WeldgateError, OSError."""
    load(settings)
    keys = keys_folder(settings)
    code = make_code(keys)
    print(f"commissioning code: {code}")
    print("Enter it in the window (Setup, Login) with a new name and PIN: it makes one administrator.")
    print(f"The keys of this installation are in {keys}. Back the folder up, and keep it secret.")
    return 0
