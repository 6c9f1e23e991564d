"""Rules for plain English as tests; the glossary in deploy/docs lists the terms."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conftest import ROOT

AREAS = ("station", "synth", "models", "deploy")
"""Packages in which the rules hold."""
WITH_LETTERS = ("models",)
"""Areas whose names of one letter have not been gone through yet."""
PAGES = sorted(path for path in (ROOT / "deploy").rglob("*.md"))
PAGES = [path for path in PAGES if path.name != "glossary.md"]
PAGES += [ROOT / "CHANGELOG.md"]
"""Pages of prose, without the glossary, which lists the banned phrases."""
SOURCES = sorted({path for area in AREAS for path in [ROOT / area, *(ROOT / area).rglob("*.py")]})
SOURCES = [path for path in SOURCES if path.suffix == ".py"]

BANNED = re.compile(
    r"""\b(
        told | let\ go | anew | stands?\ in | of\ mean | whoever | nobody\ knows | by\ itself | goes?\ on
        | wanted
        | (?<!there\ )is\ no(?!\ longer|\ more) | with\ \*\ behind | work\ ?pieces? | golden\ parts?
        | least\ lengths? | (dark|saturated)\ share | shares?\ of | refused\ segments? | test\ pictures?
        | setting-up\ pictures? | held\ against | taken\ out | said\ to\ be | knobs?
    )\b""",
    re.VERBOSE | re.IGNORECASE,
)
"""Phrases that are German in English words, and words that the glossary replaces."""
NO_BEGINNING = ("Of ", "Of.", "The same", "If ", "All ", "Whether ")
"""How no docstring of a function, class or module begins."""
ALLOWED = ("--knob",)
"""Texts of the code that name something old on purpose."""
SHORT_NAMES = frozenset("_ixy")
"""Names of one letter that every function may use: unused, index, coordinates."""
FORMULAS = (
    *(f"synth/{name}.py" for name in ("camera/lights", "camera/render", "camera/scene", "defects/hole")),
    *(f"synth/measured/{name}.py" for name in ("artificial", "measurement", "spectrum")),
    *(f"synth/output/{name}.py" for name in ("calibrate", "figures", "labels", "shard")),
    *("synth/part/borders.py", "synth/part/recipe.py", "synth/recipes/toml_file.py"),
    *(f"synth/surface/{name}.py" for name in ("materials", "mesh", "noise", "ripples", "topography")),
    "station/classify/onnx.py",
    "station/panel/look/theme.py",
    "station/plc/block/timers.py",
    "station/plc/block/transcribe.py",
)
"""Files whose formulas use letters as in mathematics."""


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def texts(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the docstrings, comments and string literals of a file, each with its line."""
    source = path.read_text()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            joined = re.sub(r"[ \t]*\n[ \t]*", " ", node.value)
            yield node.lineno, joined
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string


def docstrings(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the docstrings of a module and of its public functions and classes."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            if not node.name.startswith("_") or node.name.startswith("__"):
                yield node.lineno, ast.get_docstring(node) or ""
        elif isinstance(node, ast.Module):
            yield 1, ast.get_docstring(node) or ""


def violations(path: Path, found: Iterator[tuple[int, str]]) -> list[str]:
    return [
        f"{name_of(path)}:{line}: {match[0]!r} in {text[max(0, match.start() - 40) : match.end() + 20]!r}"
        for line, text in found
        for match in BANNED.finditer(text)
        if text not in ALLOWED
    ]


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_code_uses_no_banned_phrase(path: Path) -> None:
    found = violations(path, texts(path))
    assert not found, "\n".join(found)


@pytest.mark.parametrize("path", PAGES, ids=name_of)
def test_pages_use_no_banned_phrase(path: Path) -> None:
    prose = enumerate(path.read_text().splitlines(), 1)
    found = violations(path, ((line, re.sub(r"`[^`]*`", "", text)) for line, text in prose))
    assert not found, "\n".join(found)


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_docstrings_say_what_a_thing_is_or_does(path: Path) -> None:
    found = [f"{name_of(path)}:{line}: {text[:60]!r}" for line, text in docstrings(path)]
    found = [line for line in found if line.split(": ", 1)[1][1:].startswith(NO_BEGINNING)]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    "path", [path for path in SOURCES if path.is_relative_to(ROOT / "station" / "panel")], ids=name_of
)
def test_labels_of_the_window_say_minimum_and_maximum(path: Path) -> None:
    found = [
        f"{name_of(path)}:{line}: {text!r}"
        for line, text in texts(path)
        if re.match(r"(the )?(least|greatest|lowest allowed)\b", text, re.IGNORECASE)
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    "path",
    [
        path
        for path in SOURCES
        if not name_of(path).startswith(WITH_LETTERS) and name_of(path) not in FORMULAS
    ],
    ids=name_of,
)
def test_names_of_one_letter_stay_in_formulas(path: Path) -> None:
    tree = ast.walk(ast.parse(path.read_text()))
    stored = [
        (node.lineno, node.id if isinstance(node, ast.Name) else node.arg)
        for node in tree
        if (isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)) or isinstance(node, ast.arg)
    ]
    found = [
        f"{name_of(path)}:{line}: {name}"
        for line, name in stored
        if len(name) == 1 and name not in SHORT_NAMES
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    ("text", "is_banned"),
    [
        ("the oldest are let go", True),
        ("whoever works here", True),
        ("serial 'A' is no master", True),
        ("there is no archive", False),
        ("its image is no longer kept", False),
        ("the outstanding insert", False),
    ],
)
def test_the_rule_finds_what_it_should(text: str, is_banned: bool) -> None:
    assert bool(BANNED.search(text)) is is_banned
