"""Everything in the window is translated and readable: no English in the German, no grey on grey."""

import ast
import shutil
import xml.etree.ElementTree as ElementTree
from itertools import product
from pathlib import Path
from types import ModuleType

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from deploy.docs.translations import PANEL, TS, release, untranslated, update
from deploy.docs.window_words import ONE_FOR_EACH_LEVEL, spoken, window_words
from station.channel.requests import FAULT, TOO_OLD
from station.defects import Reason
from station.domain import Origin, Purpose, Verdict
from station.engine.operator_desk import OTHER_IN_SERVICE
from station.engine.operator_requests import TOO_MANY
from station.engine.rights import needed
from station.engine.settings_change import NO_MOMENT
from station.engine.settings_use import CAMERA_REFUSES, RELOAD_REFUSED
from station.journal.journal import Kind
from station.journal.reviews import Opinion, State
from station.journal.users import Level
from station.panel.look import words
from station.panel.look.purposes import PURPOSE_WORDS
from station.panel.look.theme import THEMES, Colors
from station.panel.session.lamp import WHY_OFFLINE
from station.panel.session.pending import NO_CONNECTION
from station.plc.map.alarms import TEXTS, Explained


def messages(ts: Path) -> set[tuple[str, str, str]]:
    """(context, source, translation)"""
    return {
        (context.findtext("name") or "", m.findtext("source") or "", m.findtext("translation") or "")
        for context in ElementTree.parse(ts).getroot().iter("context")
        for m in context.iter("message")
    }


def test_every_text_is_translated_and_the_binary_file_is_up_to_date(tmp_path: Path) -> None:
    ts, qm = tmp_path / TS.name, tmp_path / "made.qm"
    shutil.copy(TS, ts)
    update(ts)
    assert untranslated(ts) == [], "run make translations, then translate"
    assert messages(ts) == messages(TS), "run make translations"
    release(ts, qm)
    assert qm.read_bytes() == TS.with_suffix(".qm").read_bytes(), "run make translations"


def test_every_text_of_the_code_is_seen_by_the_translators() -> None:
    """Qt's lupdate overlooks a text inside an f-string."""
    written = {
        (str(node.args[0].value), str(node.args[1].value))
        for path in sorted(PANEL.rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id == "translate"
        and isinstance(node.args[0], ast.Constant)
        and isinstance(node.args[1], ast.Constant)
    }
    assert len(written) > 200
    assert written <= {(context, source) for context, source, _ in messages(TS)}


def test_places_for_values_are_in_the_translation_too() -> None:
    for _, source, german in messages(TS):
        for place in ("{n}", "{released}", "{rejected}", "{parts}", "{left_out}", "{kind}"):
            assert (place in source) == (place in german)


def test_a_new_kind_of_defect_or_alarm_is_translated_without_another_list(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(TEXTS, 0x3FFF, Explained("the coolant leaks", "close the valve"))
    ts = tmp_path / TS.name
    shutil.copy(TS, ts)
    update(ts)
    assert sorted(untranslated(ts)) == ["close the valve", "the coolant leaks"]


def test_the_words_of_the_station_are_collected_where_they_are_said() -> None:
    found = window_words()
    expected = [
        *Verdict,
        *Reason,
        *Origin,
        *PURPOSE_WORDS.values(),
        *Kind,
        *Opinion,
        *State,
        *WHY_OFFLINE.values(),
    ]
    expected += [level.name.lower() for level in Level]
    expected += [text for explained in TEXTS.values() for text in (explained.cause, explained.action)]
    expected += [
        TOO_OLD,
        FAULT,
        OTHER_IN_SERVICE,
        TOO_MANY,
        NO_MOMENT,
        CAMERA_REFUSES,
        RELOAD_REFUSED,
        NO_CONNECTION,
    ]
    assert {str(word) for word in expected} <= set(found)
    assert len(found) == len(set(found))
    assert set(PURPOSE_WORDS) == set(Purpose)


def test_every_refusal_for_want_of_a_level_is_collected() -> None:
    assert {needed(request) for request in ONE_FOR_EACH_LEVEL} == set(Level)


SAID = '''
"""A module."""
REASON, OTHER = "it is too late", "never seen"
LIMIT = 4
TABLE = {1: "one thing", 2: REASON}
TYPED: str = "declared"
def refuse(name):
    raise RefusedError(f"at most {LIMIT} are allowed")
    raise RefusedError(f"{name} is unknown")
    raise RefusedError(REASON if name else "nobody is there", code="16#1")
def why(late):
    return "late again" if late else ""
'''


@pytest.mark.parametrize(
    ("name", "texts"),
    [
        ("RefusedError", ["at most 4 are allowed", "it is too late", "nobody is there"]),
        ("why", ["late again"]),
        ("TABLE", ["one thing", "it is too late"]),
        ("REASON", ["it is too late"]),
        ("TYPED", ["declared"]),
    ],
)
def test_texts_are_found_by_the_names_that_they_go_to(tmp_path: Path, name: str, texts: list[str]) -> None:
    path = tmp_path / "said.py"
    path.write_text(SAID)
    module = ModuleType("said")
    module.__file__ = str(path)
    vars(module).update(REASON="it is too late", LIMIT=4)
    assert spoken(module, (name,)) == texts
    with pytest.raises(LookupError, match="says nothing any more"):
        spoken(module, (name, "renamed"))


def test_german_is_spoken_and_unspoken(qtbot: QtBot) -> None:
    assert isinstance(QApplication.instance(), QApplication)
    try:
        words.use("de")
        assert words.translate("window", "History") == "Verlauf"
        assert words.data(Reason.MISSING_WELD) == "fehlende Naht"
    finally:
        words.use("en")
    assert words.translate("window", "History") == "History"


def luminance(color: str) -> float:
    """WCAG 2.1, relative luminance."""
    parts = [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    r, g, b = (p / 12.92 if p <= 0.03928 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


def contrast(one: str, other: str) -> float:
    """WCAG 2.1, contrast ratio."""
    a, b = sorted((luminance(one), luminance(other)), reverse=True)
    return (a + 0.05) / (b + 0.05)


@pytest.mark.parametrize("theme", THEMES.values(), ids=THEMES)
def test_text_has_a_contrast_of_four_and_a_half(theme: Colors) -> None:
    pairs = list(product((theme.text, theme.quiet), (theme.background, theme.surface)))
    pairs += [(theme.text, theme.raised), (theme.background, theme.accent)]
    pairs += [(theme.on_color, color) for color in (theme.good, theme.warn, theme.test)] + [
        (theme.on_bad, theme.bad)
    ]
    pairs += list(product((theme.bad_text, theme.warn_text), (theme.background, theme.surface)))
    assert min(contrast(*pair) for pair in pairs) >= 4.5, sorted(
        (round(contrast(*pair), 2), pair) for pair in pairs
    )[:3]
