"""Everything on the window is translated and can be read: nothing in English under German, nothing grey on grey."""

import shutil
import xml.etree.ElementTree as ElementTree
from itertools import product
from pathlib import Path

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from deploy.docs.translations import TS, release, untranslated, update
from station.defects import Reason
from station.domain import Origin, Purpose
from station.journal.journal import Kind
from station.journal.reviews import Opinion, State
from station.journal.users import Level
from station.panel.look import words
from station.panel.look.theme import THEMES, Colors
from station.panel.look.vocabulary import WORDS
from station.panel.session.lamp import WHY_OFFLINE
from station.plc.map.alarms import TEXTS


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


def test_places_for_values_are_in_the_translation_too() -> None:
    for _, source, german in messages(TS):
        for place in ("{n}", "{released}", "{refused}"):
            assert (place in source) == (place in german)


def test_the_vocabulary_has_every_word_of_the_station() -> None:
    needed = [
        *Reason,
        *Origin,
        *Purpose,
        *Kind,
        *Opinion,
        *State,
        *WHY_OFFLINE.values(),
        *(level.name.lower() for level in Level),
    ]
    needed += [text for explained in TEXTS.values() for text in (explained.cause, explained.action)]
    assert {str(word) for word in needed} <= set(WORDS)


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
