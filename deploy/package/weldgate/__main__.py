"""`python -m weldgate` is `weldgate`."""

import sys

from weldgate import run_station

if __name__ == "__main__":
    sys.exit(run_station())
