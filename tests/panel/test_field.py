"""Fields for numbers read a decimal comma alike."""

import pytest
from pytestqt.qtbot import QtBot

from station.panel.widgets.field import NumberField, SegmentLimits


@pytest.mark.parametrize("text", ["1: 0,6", "1: 0.6", " 1:0,6 ", "1: 0,6;"])
def test_both_fields_read_both_signs(qtbot: QtBot, text: str) -> None:
    number, limits = NumberField(0.01, 0.99), SegmentLimits()
    qtbot.addWidget(number)
    qtbot.addWidget(limits)
    number.edit.setText("0,6")
    limits.edit.setText(text)
    assert number.value == 0.6
    assert limits.value == {1: 0.6}


@pytest.mark.parametrize("text", ["1: 0.6, 1: 0.7", "22: 0,5", "1: 1,5", "1: 0_5", "1"])
def test_what_is_not_valid_is_refused(qtbot: QtBot, text: str) -> None:
    limits = SegmentLimits()
    qtbot.addWidget(limits)
    limits.edit.setText(text)
    assert limits.value is None


def test_several_segments_with_decimal_commas(qtbot: QtBot) -> None:
    limits = SegmentLimits()
    qtbot.addWidget(limits)
    limits.edit.setText("1: 0,6; 12: 0,3")
    assert limits.value == {1: 0.6, 12: 0.3}
    limits.set({1: 0.6, 12: 0.3})
    assert limits.value == {1: 0.6, 12: 0.3}
