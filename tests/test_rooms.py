"""House rules as tests."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import ROOT

ROOMS = ("station", "synth", "models", "deploy")
SOURCES = [path for room in ROOMS for path in sorted((ROOT / room).rglob("*.py"))]


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_files_are_small_and_say_what_they_are(path: Path) -> None:
    text = path.read_text()
    assert len(text.splitlines()) <= 300
    assert text.startswith('"""')
    assert path.stem not in ("utils", "helpers", "manager", "base", "common")


def test_importing_touches_no_device_thread_or_variant() -> None:
    code = (
        "import sys, threading, importlib\n"
        "for name in ['station.startup', 'station.plc.modbus', 'station.panel.window', 'synth.dataset', 'models.train', 'deploy.demo']:\n"
        "    importlib.import_module(name)\n"
        "assert threading.active_count() == 1, threading.enumerate()\n"
        "assert 'pypylon' not in sys.modules and 'mitsuba' not in sys.modules\n"
        "from PySide6.QtWidgets import QApplication\n"
        "assert QApplication.instance() is None\n"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr


def test_the_station_alone_needs_neither_renderer_nor_torch() -> None:
    code = "import sys, station.startup, station.replay.command\nassert not {'torch', 'mitsuba', 'synth', 'models'} & set(sys.modules)\n"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
