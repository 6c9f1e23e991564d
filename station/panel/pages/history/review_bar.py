"""The fields by which a user reviews a part: comment and opinions, and the state of the review."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QWidget

from station.archive.reader import Row
from station.domain import Verdict
from station.journal.reviews import Opinion, Review, State, possible
from station.panel.look.words import data, translate
from station.panel.widgets.card import label


class ReviewBar(QWidget):
    """Comment and one button for each opinion; `state` is placed by the page."""

    given = Signal(object)
    """Carries the Opinion that was chosen."""

    def __init__(self) -> None:
        super().__init__()
        self.state = label("", "fact")
        self.comment = QLineEdit()
        self.comment.setPlaceholderText(translate("history", "comment"))
        self.opinions = {
            Opinion.RIGHT: QPushButton(translate("history", "Verdict is right")),
            Opinion.FALSE_CALL: QPushButton(translate("history", "False call")),
            Opinion.MISSED: QPushButton(translate("history", "Missed defect")),
        }
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.comment, 1)
        for opinion, button in self.opinions.items():
            button.clicked.connect(lambda _=False, chosen=opinion: self.given.emit(chosen))
            row.addWidget(button)

    def show_review(
        self, row: Row | None, review: Review | None, *, logged_in: bool, marked: bool, waiting: bool
    ) -> None:
        """Show the opinions about a part, and enable the opinions that can be given.

        `marked`: segments with a missed defect are marked; `waiting`: the engine has not yet answered.
        """
        for opinion, button in self.opinions.items():
            allowed = logged_in and not waiting and (marked or opinion is not Opinion.MISSED)
            button.setEnabled(allowed and row is not None and opinion in possible(row.verdict))
        self.state.setText("" if row is None else _state(row, review, logged_in, marked))


def _state(row: Row, review: Review | None, logged_in: bool, marked: bool) -> str:
    """Return the state of the review, the opinions so far, and a hint on what can be done."""
    opinions = {} if review is None else review.opinions
    hint = ""
    if not logged_in:
        hint = translate("history", "log in to review")
    elif row.verdict == Verdict.OK and not marked:
        hint = translate("history", "touch the segments in which a defect was missed")
    given = ", ".join(f"{who}: {data(opinion)}" for who, opinion in opinions.items())
    state = data(State.NONE if review is None else review.state)
    return " · ".join(text for text in (state, given, hint) if text)
