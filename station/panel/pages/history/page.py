"""The page History: finds recorded parts, shows one of them with its record, takes reviews and exports."""

from collections.abc import Sequence

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QHBoxLayout, QPushButton, QSplitter, QVBoxLayout, QWidget

from station.archive.reader import Query, Row, find
from station.channel.requests import Answer, GiveReview
from station.errors import RecordError
from station.journal.reviews import Opinion, Review, reviews
from station.panel.look.words import data, translate
from station.panel.pages.history.export_bar import ExportBar
from station.panel.pages.history.fields import SearchFields
from station.panel.pages.history.filmstrip import Filmstrip
from station.panel.pages.history.record_view import RecordView
from station.panel.pages.history.review_bar import ReviewBar
from station.panel.pages.history.search import FOUND
from station.panel.pages.page import Page
from station.panel.session.session import Session
from station.panel.widgets.card import label
from station.panel.widgets.weld.recorded import defect_map, thumbnails
from station.panel.widgets.work import WorkBar

REFRESH_MS = 1000
GALLERY = 60
"""Maximum number of images that are read for the gallery."""


class HistoryPage(Page):
    """Reads the archive; works without a running engine, except for reviews."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.film, self.record, self.reviewing, self.work = Filmstrip(), RecordView(), ReviewBar(), WorkBar()
        self.exports = ExportBar(session, self.work, lambda: list(self.film.rows))
        self._newest = 0
        """Number of the newest part at the last search."""
        self._thumbs: dict[int, QImage] = {}
        """Images that were read for the gallery, by number of the part."""
        self.waiting = False
        """True while the engine has not answered to a review."""
        self._review: Review | None = None
        """Review of the chosen part."""
        self._lay_out()
        self.film.currentItemChanged.connect(self.show_chosen)
        self.record.marked.connect(self._refresh_buttons)
        self.reviewing.given.connect(self.give_review)
        self.gallery.toggled.connect(self._on_gallery)
        self.fields.asked.connect(self.search)
        self.work.failed.connect(lambda why: self._problem.setText(data(why)))
        session.account.changed.connect(self.reviewing.comment.clear)
        session.account.changed.connect(self.record.clear_marks)
        session.account.changed.connect(self._read_review)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._follow)
        self._timer.start(REFRESH_MS)
        self.search()
        self._read_review()

    def _lay_out(self) -> None:
        self.fields, self.gallery = SearchFields(), QPushButton(translate("history", "Gallery"))
        self.gallery.setCheckable(True)
        top = QHBoxLayout()
        top.addWidget(self.fields, 1)
        top.addWidget(self.gallery, 0, Qt.AlignmentFlag.AlignTop)
        self._count, self._problem = label("", "quiet"), label("", "problem", wrap=True)
        left = QWidget()
        column = QVBoxLayout(left)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.film, 1)
        column.addWidget(self._count)
        column.addWidget(self.exports.result)
        split = QSplitter(Qt.Orientation.Horizontal)
        split.addWidget(left)
        split.addWidget(self.record)
        split.setSizes([310, 780])
        split.setStretchFactor(1, 1)
        self.show_map = QPushButton(translate("history", "Defect map"))
        self.show_map.clicked.connect(self._ask_map)
        bottom = QHBoxLayout()
        bottom.addWidget(self.reviewing, 1)
        bottom.addWidget(self.show_map)
        bottom.addWidget(self.exports)
        rows = QVBoxLayout(self)
        rows.addLayout(top)
        rows.addWidget(split, 1)
        rows.addWidget(self.reviewing.state)
        rows.addLayout(bottom)
        rows.addWidget(self.work)
        rows.addWidget(self._problem)

    def search(self) -> None:
        """Search the index by the fields and show what is found."""
        try:
            rows, known = self.fields.search(self._session.received.folder)
        except RecordError as error:
            rows, known = [], {}
            self._problem.setText(str(error))
        else:
            self._problem.setText("")
        last = self._session.received.last
        self._newest = 0 if last is None else last.record.inspection_id
        found = {row.inspection_id for row in rows}
        self._thumbs = {number: image for number, image in self._thumbs.items() if number in found}
        self.film.fill(rows, self._known_thumbs(), known)
        limited, every = translate("history", "newest {n} parts"), translate("history", "{n} parts")
        self._count.setText((limited if len(rows) == FOUND else every).format(n=len(rows)))
        if self.film.chosen() is None and rows:
            self.film.setCurrentRow(0)
        elif not rows:
            self.show_chosen()
        if self.gallery.isChecked():
            self._read_thumbs(rows)

    def open_part(self, number: int) -> None:
        """Show this part, whatever was searched for before."""
        self.fields.clear()
        self.search()
        if number not in self.film.rows:
            older = find(self._session.received.folder, Query(number=number))
            self.film.fill([*older, *self.film.rows.values()], self._session.received.thumbs, self._reviews())
        self.film.setCurrentRow(list(self.film.rows).index(number) if number in self.film.rows else -1)

    def _follow(self) -> None:
        """Add new parts automatically, but not while somebody looks further down."""
        last = self._session.received.last
        newer = last is not None and last.record.inspection_id != self._newest
        if newer and self.isVisible() and not self.work.busy and self.film.verticalScrollBar().value() == 0:
            self.search()

    def _chosen_row(self) -> Row | None:
        number = self.film.chosen()
        return None if number is None else self.film.rows.get(number)

    def show_chosen(self) -> None:
        """Read the record of the chosen part from disk and show it."""
        row = self._chosen_row()
        if row is None:
            self.record.show_nothing()
        else:
            self.record.show_row(self._session.received.folder, row)
        self._read_review()

    def _read_review(self) -> None:
        number = self.film.chosen()
        self._review = None if number is None else self._reviews().get(number)
        self._refresh_buttons()

    def _refresh_buttons(self) -> None:
        row, logged_in = self._chosen_row(), self._session.account.user is not None
        marked = bool(self.record.marks)
        self.reviewing.show_review(
            row, self._review, logged_in=logged_in, marked=marked, waiting=self.waiting
        )
        self.exports.setEnabled(logged_in)
        self.show_map.setEnabled(row is not None and self.record.strip_shown)

    def _reviews(self) -> dict[int, Review]:
        """Return all reviews; show a message if they cannot be read."""
        try:
            return reviews(self._session.received.folder)
        except RecordError as error:
            self._problem.setText(str(error))
            return {}

    def give_review(self, opinion: Opinion) -> None:
        """Ask the engine to record this opinion of the chosen part in the name of the user."""
        number = self.film.chosen()
        if number is None:
            return
        marks = self.record.marks if opinion is Opinion.MISSED else {}
        self.waiting = True
        self._refresh_buttons()
        request = GiveReview(number, opinion, self.reviewing.comment.text().strip(), dict(marks))
        self._session.account.ask(request, self._on_answer, self)

    def _on_answer(self, answer: Answer) -> None:
        self.waiting = False
        if answer.done:
            self.reviewing.comment.clear()
            self.record.clear_marks()
            self.search()
        else:
            self._problem.setText(data(answer.refusal))
        self._read_review()

    def _on_gallery(self, gallery: bool) -> None:
        self.film.as_gallery(gallery)
        self.search()

    def _known_thumbs(self) -> dict[int, QImage]:
        return {**self._thumbs, **self._session.received.thumbs}

    def _read_thumbs(self, rows: Sequence[Row]) -> None:
        folder, known = self._session.received.folder, self._known_thumbs()
        missing = [row for row in rows[:GALLERY] if row.inspection_id not in known]
        if missing and not self.work.busy:
            self.work.start(
                translate("history", "Reading images"),
                lambda progress: thumbnails(folder, missing, progress),
                self._on_thumbs,
            )

    def _on_thumbs(self, found: dict[int, QImage]) -> None:
        self._thumbs |= found
        self.film.fill(list(self.film.rows.values()), self._known_thumbs(), self._reviews())

    def _ask_map(self) -> None:
        record, settings = self.record.record, self._session.received.settings
        if record is not None:
            title = translate("history", "Computing the defect map")
            self.work.start(title, lambda _: defect_map(settings, record), self._on_map)

    def _on_map(self, made: tuple[int, QImage]) -> None:
        number, overlay = made
        shown = self.record.record
        if shown is not None and shown.inspection_id == number:  # else another part was chosen meanwhile
            self.record.strip.show_map(overlay)

    def close_page(self) -> None:
        """Stop timer and work."""
        self._timer.stop()
        self.work.close_work()
