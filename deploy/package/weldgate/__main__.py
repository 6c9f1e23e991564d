"""Runs `weldgate` as `python -m weldgate`."""

import sys

from weldgate import run_station

if __name__ == "__main__":
    sys.exit(run_station())
