"""The site: rooms without circles, an API from the docstrings, nothing loaded from a network."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from deploy.docs.api import entries, page
from deploy.docs.layered import Box, draw, levels_of
from deploy.docs.offline import loaded_from_network
from deploy.docs.rooms import (
    MOST_ROOMS,
    PACKAGES,
    Import,
    Layers,
    broken,
    contracts,
    imports_of,
    rooms_of,
    without_implied,
)
from deploy.docs.sources import LinkError, stage
from tests.conftest import ROOT


@pytest.mark.parametrize("package", PACKAGES)
def test_the_rooms_have_no_circle_and_no_arrow_up_and_can_be_taken_in(package: str) -> None:
    rooms = rooms_of(*imports_of(ROOT), package)
    assert not broken(rooms, contracts(ROOT / "pyproject.toml"))
    assert 1 < len(rooms.modules) <= MOST_ROOMS


MODULES = (
    "app",
    "app.facts",
    "app.low",
    "app.low.a",
    "app.high",
    "app.high.b",
    "app.high.c",
    "other",
    "other.x",
)


def test_a_room_is_a_folder_or_a_loose_file_and_the_lowest_loose_files_are_the_ground() -> None:
    loose = ("app.top",)
    imports = [
        Import("app.low.a", "app.facts"),
        Import("app.top", "app.low.a"),
        Import("other.x", "app.high.b"),
    ]
    rooms = rooms_of((*MODULES, *loose), imports, "app")
    assert rooms.modules == {
        "app/ground": ("app", "app.facts"),
        "app/high": ("app.high", "app.high.b", "app.high.c"),
        "app/low": ("app.low", "app.low.a"),
        "app/top": ("app.top",),
        "other": ("other", "other.x"),
    }
    assert set(rooms.arrows) == {("app/low", "app/ground"), ("app/top", "app/low"), ("other", "app/high")}


def test_a_circle_is_reported_once_with_both_files() -> None:
    imports = [Import("app.high.b", "app.low.a"), Import("app.low.a", "app.high.c")]
    (line,) = broken(rooms_of(MODULES, imports, "app"), [])
    assert "app/high/b.py imports app/low/a.py" in line
    assert "app/low/a.py imports app/high/c.py" in line


@pytest.mark.parametrize(
    "floors", [(["high"], ["low"]), (["high", "low"],)], ids=["from below", "between siblings"]
)
def test_an_arrow_that_does_not_lead_down_is_reported_with_both_files(floors: tuple[list[str], ...]) -> None:
    rooms = rooms_of(MODULES, [Import("app.low.a", "app.high.b")], "app")
    (line,) = broken(rooms, [Layers("app", tuple(map(frozenset, floors)))])
    assert line.startswith("arrow up: app/low/a.py imports app/high/b.py")
    assert not broken(rooms, [Layers("app", (frozenset({"low"}), frozenset({"high"})))])


def test_an_arrow_that_a_longer_way_implies_is_left_out() -> None:
    imports = [
        Import("app.high.b", "app.low.a"),
        Import("app.low.a", "app.facts"),
        Import("app.high.c", "app.facts"),
    ]
    rooms = rooms_of(MODULES, imports, "app")
    assert set(without_implied(rooms)) == {("app/high", "app/low"), ("app/low", "app/ground")}


def test_a_drawing_has_all_boxes_and_its_arrows_point_down() -> None:
    boxes = [Box(name, name, "own", name) for name in ("a", "b", "c", "d")]
    arrows = [("a", "b"), ("b", "c"), ("a", "d"), ("d", "c")]
    drawing = draw(boxes, arrows, [("a", "c")], "a <drawing>")
    assert re.findall(r"<text[^>]*>(\w)</text>", drawing) == ["a", "b", "c", "d"]
    assert "a &lt;drawing&gt;" in drawing
    assert levels_of({"a": ["b", "d"], "b": ["c"], "c": [], "d": ["c"]}) == {"a": 2, "b": 1, "c": 0, "d": 1}
    for path in re.findall(r'class="line" d="M([^"]+)"', drawing):
        numbers = [float(number) for number in re.findall(r"[\d.]+", path)]
        assert numbers[-1] > numbers[1]


def test_the_api_shows_what_is_public_with_its_words() -> None:
    source = '''
LIMIT = 3
"""Most of them."""
_HIDDEN = 4
"""Not shown."""
class Part(Base):
    """One part."""
    name: str = "x"
    """Its name."""
    @property
    def size(self) -> int:
        """Size in mm."""
    @classmethod
    def of(cls, text: str) -> "Part":
        """Read it."""
class Made:
    """Made of parts."""
    def __init__(self, parts: int = 2) -> None:
        """Any number."""
def _no() -> None: ...
async def run(part: Part, *, fast: bool = True) -> None:
    """Run it."""
'''
    found = list(entries(ast.parse(source).body))
    assert [(entry.directive, entry.signature) for entry in found] == [
        ("data", "LIMIT"),
        ("class", "Part(Base)"),
        ("class", "Made(parts: int=2)"),
        ("function", "run(part: Part, *, fast: bool=True) -> None"),
    ]
    assert found[2].text == "Made of parts.\n\nAny number."
    assert [(entry.directive, entry.signature, entry.text) for entry in found[1].inner] == [
        ("attribute", "name", "Its name."),
        ("property", "size", "Size in mm."),
        ("method", "of(text: str) -> 'Part'", "Read it."),
    ]


def test_the_api_of_a_folder_has_all_of_its_files() -> None:
    text = page(ROOT, ROOT / "station" / "camera")
    for path in (ROOT / "station" / "camera").glob("*.py"):
        assert path.stem == "__init__" or f".. py:module:: station.camera.{path.stem}\n" in text


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.html", '<script src="https://cdn.example/x.js"></script>'),
        ("a.html", '<link rel="stylesheet" href="//fonts.example/a.css">'),
        ("a.html", '<img src="http://example/a.png">'),
        ("a.css", "@import url(https://fonts.example/a.css);"),
        ("a.js", 'import("https://cdn.example/mermaid.mjs")'),
    ],
)
def test_what_a_browser_would_load_from_elsewhere_is_found(name: str, text: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    (found,) = set(loaded_from_network(tmp_path))
    assert found.startswith(f"{name} loads ")


def test_links_to_other_sites_and_own_files_are_not_loaded_from_elsewhere(tmp_path: Path) -> None:
    text = '<a href="https://example.org">x</a><link rel="canonical" href="https://e.org"><img src="a.png">'
    (tmp_path / "a.html").write_text(text)
    assert not list(loaded_from_network(tmp_path))


def test_a_link_that_leads_nowhere_is_named_with_its_line(tmp_path: Path) -> None:
    docs = tmp_path / "deploy" / "docs"
    docs.mkdir(parents=True)
    (docs / "index.md").write_text("# Pages\n\nSee [this](nowhere.md).\n")
    with pytest.raises(LinkError, match=r"deploy/docs/index.md:3: nowhere.md does not exist"):
        stage(tmp_path, tmp_path / "staged")


def test_the_site_is_built_without_a_warning_and_needs_no_network(tmp_path: Path) -> None:
    pytest.importorskip("sphinx", reason="make setup installs it")
    command = [sys.executable, "-m", "deploy.docs.build", "--out", str(tmp_path / "site")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    site = tmp_path / "site"
    assert not list(loaded_from_network(site))
    for name in ("index", "rooms", "troubleshooting", "plc/register-map", "api/station.camera", "search"):
        assert (site / f"{name}.html").exists(), name
    assert "16#3001" in (site / "troubleshooting.html").read_text(encoding="utf-8")
    assert "svg" in (site / "rooms.html").read_text(encoding="utf-8")
