"""Pages of the documentation: what they name exists."""

import ast
import re
import tomllib
from typing import Any

import pytest
from pydantic import BaseModel

from deploy.docs.sources import links, target_of
from station.defects import Reason
from station.plc.handshake_state import Phase
from station.plc.map.alarms import TEXTS
from station.plc.map.registers import ERROR_NOT_JUDGED, Offline
from station.settings.model import Settings
from tests.conftest import ROOT
from tests.deploy.pages import (
    COMMANDS,
    PAGES,
    anchors,
    blocks,
    code_spans,
    commands,
    existing,
    headings,
    help_of,
    make_targets,
    refusal,
    text_of,
)

TROUBLE = "deploy/docs/troubleshooting.md"
GLOSSARY = "deploy/docs/glossary.md"
ARCHITECTURE = "deploy/docs/architecture.md"
TO_BE_MADE = re.compile(r"NAME|crack|FOLDER")
"""Marks names in a recipe that its reader chooses."""
LONGEST = 110


@pytest.mark.parametrize("page", [*PAGES, "README.md"])
def test_links_and_anchors_exist(page: str) -> None:
    for link in links(text_of(page)):
        if "://" in link.target:
            continue
        path, anchor = target_of(page, link.target)
        assert existing(path), f"{page}:{link.line}: {link.target} does not exist"
        if anchor and path.endswith(".md"):
            assert anchor in anchors(path), f"{page}:{link.line}: {path} has no heading {anchor!r}"


@pytest.mark.parametrize("page", PAGES)
def test_named_files_exist(page: str) -> None:
    if page == "CHANGELOG.md":  # tells of files that have moved since
        return
    for span in code_spans(page):
        if re.fullmatch(r"(station|synth|models|deploy|tests)/[\w./-]+", span) and not TO_BE_MADE.search(
            span
        ):
            assert existing(span), f"{page}: {span} does not exist"


@pytest.mark.parametrize("page", PAGES)
def test_commands_in_blocks_are_understood(page: str) -> None:
    for words in commands(page):
        name = words[0].removeprefix(".venv/bin/")
        if name in COMMANDS:
            assert not (why := refusal(name, words[1:])), f"{page}: {' '.join(words)}: {why}"
        elif name == "make":
            assert set(words[1:]) <= make_targets(), f"{page}: {' '.join(words)}"
        elif words[1:3] == ["-m", "pytest"]:
            assert all(existing(word) for word in words[3:] if not word.startswith("-")), f"{page}: {words}"
        else:
            assert name in ("export", "python") or words[1:3] == ["-m", "pip"], (
                f"{page}: {name} is not known here"
            )


@pytest.mark.parametrize("page", PAGES)
def test_commands_in_the_text_exist_with_their_options(page: str) -> None:
    if page == "CHANGELOG.md":  # tells of commands as they were
        return
    for span in code_spans(page):
        name, *rest = span.removeprefix(".venv/bin/").split()
        if name == "make" and rest:
            assert set(rest) <= make_targets(), f"{page}: {span}"
        if name not in COMMANDS:
            continue
        subcommands = []
        for word in rest:
            if not re.fullmatch(r"[a-z][a-z-]*", word) or not help_of(name, *subcommands, word):
                break
            subcommands.append(word)
        assert subcommands or not rest or rest[0].startswith("-"), f"{page}: {span}: no such command"
        known = help_of(name, *subcommands)
        for option in re.findall(r"(?<!\S)--?[a-z][a-z-]*", " ".join(rest)):
            assert re.search(rf"(?<![\w-]){option}(?![\w-])", known), f"{page}: {span}: no option {option}"


@pytest.mark.parametrize("page", PAGES)
def test_modules_that_are_run_exist(page: str) -> None:
    if page == "CHANGELOG.md":
        return
    for module in re.findall(r"python -m ((?:station|synth|models|deploy)[\w.]*)", text_of(page)):
        path = module.replace(".", "/")
        assert existing(f"{path}.py") or existing(f"{path}/__main__.py"), f"{page}: python -m {module}"


def _has_key(model: Any, keys: list[str]) -> bool:
    if not (isinstance(model, type) and issubclass(model, BaseModel)):
        return True
    field = model.model_fields.get(keys[0])
    if field is None:
        return False
    kinds = getattr(field.annotation, "__args__", None) or (field.annotation,)
    return len(keys) == 1 or any(_has_key(kind, keys[1:]) for kind in kinds)


@pytest.mark.parametrize("page", PAGES)
def test_named_settings_exist(page: str) -> None:
    if page == "CHANGELOG.md":
        return
    sections = "|".join(Settings.model_fields)
    for span in code_spans(page):
        found = re.fullmatch(rf"\[?((?:{sections})(?:\.[a-z_0-9]+)+)\]?", span)
        if found and not re.search(r"\.(sqlite|json|toml|onnx|py)$", span):
            assert _has_key(Settings, found[1].split(".")), f"{page}: no setting {span}"


@pytest.mark.parametrize("page", PAGES)
def test_blocks_of_code_can_be_read(page: str) -> None:
    for block in blocks(page, "python"):
        ast.parse(block.text)
    for block in blocks(page, "toml"):
        read = tomllib.loads(block.text)
        if set(read) <= set(Settings.model_fields):
            Settings.model_validate({"camera": {"kind": "pylon", "serial": "1"}, **read})


@pytest.mark.parametrize("page", [page for page in PAGES if page.startswith("deploy/docs/")])
def test_lines_are_short(page: str) -> None:
    prose = re.sub(r"^```.*?^```", "", text_of(page), flags=re.MULTILINE | re.DOTALL)
    long = [line for line in prose.splitlines() if len(line) > LONGEST and not line.startswith("|")]
    assert not long, f"{page}: {long[0]}"


def _entries() -> dict[int, str]:
    """Text of each entry of the page on trouble by its code."""
    parts = re.split(r"^### 16#([0-9A-F]{4}) .+$", text_of(TROUBLE), flags=re.MULTILINE)
    return {
        int(code, 16): text.split("\n## ")[0] for code, text in zip(parts[1::2], parts[2::2], strict=True)
    }


def test_every_error_code_has_an_entry_and_no_other_has() -> None:
    assert set(_entries()) == set(TEXTS)
    codes = [heading for heading in headings(TROUBLE) if heading.startswith("16#")]
    assert len(codes) == len(TEXTS)
    assert codes == sorted(codes)


@pytest.mark.parametrize("code", TEXTS, ids=lambda code: f"{code:04X}")
def test_an_entry_says_meaning_causes_action_and_what_the_plc_sees(code: int) -> None:
    entry = _entries()[code]
    labels = re.findall(r"^\*\*(.+?):\*\*", entry, re.MULTILINE)
    assert labels == ["It means", "Likely causes", "Do this", "The PLC sees"]
    assert re.search(r"^1\. ", entry, re.MULTILINE)
    reason = {ERROR_NOT_JUDGED + reason.code: reason.code for reason in Reason}.get(code)
    if reason is not None:
        assert f"REASON {reason}," in entry


def test_every_reason_why_ready_is_0_is_explained() -> None:
    rows = re.findall(r"^\| (\d+) \| (\w+) \| .+ \|$", text_of(TROUBLE), re.MULTILINE)
    assert [(int(value), name) for value, name in rows] == [
        (int(offline), offline.name) for offline in Offline
    ]


def test_the_glossary_is_sorted_and_says_each_term_once() -> None:
    terms = re.findall(r"^\*\*(.+)\*\*\n: ", text_of(GLOSSARY), re.MULTILINE)
    assert len(terms) > 30
    assert terms == sorted(set(terms), key=str.casefold)


def test_the_drawing_of_the_handshake_has_its_states() -> None:
    drawing = (ROOT / "deploy" / "docs" / "drawings" / "handshake.svg").read_text(encoding="utf-8")
    assert set(re.findall(r'class="in head"[^>]*>(\w+)<', drawing)) == {phase.name for phase in Phase}


def test_the_threads_of_the_engine_are_drawn_and_listed() -> None:
    engine = [path for path in (ROOT / "station").rglob("*.py") if "panel" not in path.parts]
    source = "".join(path.read_text(encoding="utf-8") for path in engine)
    names = set(re.findall(r'Thread\([^)]*name="(\w+)"', source)) | set(
        re.findall(r'PoolExecutor\(1, "(\w+)"', source)
    )
    assert len(names) >= 6
    drawing = (ROOT / "deploy" / "docs" / "drawings" / "processes.svg").read_text(encoding="utf-8")
    for name in names:
        assert f"| `{name}` |" in text_of(ARCHITECTURE), name
        assert f">{name}<" in drawing, name
