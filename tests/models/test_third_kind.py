"""A third kind of defect, anywhere in the list: learned, exported, evaluated; old data and files are read."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import ROOT


@pytest.mark.timeout(600)
@pytest.mark.parametrize(("place", "mapped"), [(0, "mapped"), (1, "mapped"), (2, "unmapped")])
def test_the_learning_room_takes_a_third_kind(place: int, mapped: str, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.models.third_kind", str(place), mapped, str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
