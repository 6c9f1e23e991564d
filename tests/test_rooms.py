"""House rules as tests."""

import ast
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


NAMED_ROOMS = (
    "models",
    "station/panel",
    "station/plc",
    "station/engine",
    "station/channel",
    "station/camera",
    "station/journal",
    "station/__main__.py",
)
NAMED_ROOMS += tuple(f"station/{name}.py" for name in ("domain", "defects", "records", "record_versions"))
NAMED_ROOMS += tuple(f"station/{name}" for name in ("settings", "files", "vision", "classify", "inspection"))
NAMED_ROOMS += tuple(f"station/{name}" for name in ("archive", "analysis", "replay", "cli"))
NAMED_ROOMS += tuple(f"deploy/{name}" for name in ("demo", "bench", "chaos", "package"))
"""Where calls with more than four arguments must name them."""
NAMED = [path for path in SOURCES for room in NAMED_ROOMS if path.is_relative_to(ROOT / room)]
CALLED_BY_LIBRARIES = ("_gate",)


@pytest.mark.parametrize("path", NAMED, ids=lambda p: str(p.relative_to(ROOT)))
def test_a_call_with_more_than_four_arguments_names_them(path: Path) -> None:
    for node in ast.walk(ast.parse(path.read_text())):
        found: list[str] = []
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.name not in CALLED_BY_LIBRARIES:
            found = [a.arg for a in node.args.posonlyargs + node.args.args if a.arg not in ("self", "cls")]
        elif isinstance(node, ast.ClassDef) and any("frozen" in ast.unparse(d) for d in node.decorator_list):
            fields = [ast.unparse(field) for field in node.body if isinstance(field, ast.AnnAssign)]
            fields = fields[: fields.index("_: KW_ONLY")] if "_: KW_ONLY" in fields else fields
            by_name = any("kw_only=True" in ast.unparse(d) for d in node.decorator_list)
            found = [] if by_name else [field for field in fields if "kw_only=True" not in field]
        assert len(found) <= 4, f"{path.name}:{getattr(node, 'lineno', 0)}: by position {found}"


def test_importing_touches_no_device_thread_or_variant() -> None:
    code = (
        "import sys, threading, importlib\n"
        "names = ['station.engine.startup', 'station.plc.wire.modbus', 'station.panel.window']\n"
        "names += ['synth.output.dataset', 'models.classifier.train', 'deploy.demo.run']\n"
        "for name in names:\n"
        "    importlib.import_module(name)\n"
        "assert threading.active_count() == 1, threading.enumerate()\n"
        "assert 'pypylon' not in sys.modules and 'mitsuba' not in sys.modules\n"
        "from PySide6.QtWidgets import QApplication\n"
        "assert QApplication.instance() is None\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stderr


def test_the_station_alone_needs_neither_renderer_nor_torch() -> None:
    code = (
        "import sys, station.engine.startup, station.cli.replay\n"
        "assert not {'torch', 'mitsuba', 'synth', 'models'} & set(sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stderr
