"""A new bit or register is a change of the map alone: no other place drops it or keeps the old size."""

import subprocess
import sys

from tests.conftest import ROOT


def test_a_ninth_bit_a_fourth_flag_and_longer_windows_pass_everywhere() -> None:
    run = [sys.executable, "-m", "tests.plc.wider_map"]
    done = subprocess.run(run, cwd=ROOT, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.split() == ["handshake", "line", "bus", "simulated", "documents", "settings"]
