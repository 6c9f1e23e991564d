"""Past parts: the last 300 or what is searched for, one of them opened, reviewed, exported."""

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QSplitter, QVBoxLayout, QWidget

from station.analysis.export import export
from station.archive.reader import Listed, Row, Wanted, find, read_records
from station.channel.requests import Answer, GiveReview
from station.domain import Verdict
from station.errors import RecordError
from station.files.durable import replacing
from station.journal.reviews import Opinion, Review, State, possible, reviews
from station.panel.look.words import data, translate
from station.panel.pages.history.fields import SearchFields
from station.panel.pages.history.filmstrip import Filmstrip
from station.panel.pages.history.record_view import RecordView
from station.panel.pages.history.search import FOUND
from station.panel.pages.page import Page
from station.panel.session.session import Session
from station.panel.widgets.card import label
from station.panel.widgets.dialogs import ask_file, ask_folder
from station.panel.widgets.weld.kept import defect_map, small_pictures
from station.panel.widgets.work import Progress, WorkBar

REFRESH_MS = 1000
GALLERY = 60
"""Pictures read for a gallery."""


class HistoryPage(Page):
    """Reads the archive; the engine need not run."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.film, self.record = Filmstrip(), RecordView()
        self._seen = 0
        """Number of the newest part at the last search."""
        self._pictures: dict[int, QImage] = {}
        """Read for the gallery."""
        self._waiting = False
        """Whether the engine has not yet answered to a review."""
        self._review: Review | None = None
        """Of the chosen part."""
        self._lay_out()
        self.film.currentItemChanged.connect(self._on_chosen)
        self.record.marked.connect(self._look)
        self.gallery.toggled.connect(self._on_gallery)
        self.fields.asked.connect(self.search)
        self._work.failed.connect(lambda why: self._problem.setText(data(why)))
        session.account.changed.connect(self.comment.clear)
        session.account.changed.connect(self.record.clear_marks)
        session.account.changed.connect(self._on_user)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._follow)
        self._timer.start(REFRESH_MS)
        self.search()
        self._on_user()

    def _lay_out(self) -> None:
        self.fields, self.gallery = SearchFields(), QPushButton(translate("history", "Gallery"))
        self.gallery.setCheckable(True)
        top = QHBoxLayout()
        top.addWidget(self.fields, 1)
        top.addWidget(self.gallery, 0, Qt.AlignmentFlag.AlignTop)
        self._count, self._said = label("", "quiet"), label("", "quiet", wrap=True)
        self._problem, self._work = label("", "problem", wrap=True), WorkBar()
        left = QWidget()
        column = QVBoxLayout(left)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.film, 1)
        column.addWidget(self._count)
        column.addWidget(self._said)
        split = QSplitter(Qt.Orientation.Horizontal)
        split.addWidget(left)
        split.addWidget(self.record)
        split.setSizes([310, 780])
        split.setStretchFactor(1, 1)
        self.comment = QLineEdit()
        self.comment.setPlaceholderText(translate("history", "comment"))
        self._reviewed = label("", "fact")
        self.opinions = {
            Opinion.RIGHT: QPushButton(translate("history", "Verdict is right")),
            Opinion.FALSE_CALL: QPushButton(translate("history", "False call")),
            Opinion.MISSED: QPushButton(translate("history", "Missed defect")),
        }
        self.show_map = QPushButton(translate("history", "Defect map"))
        self.show_map.clicked.connect(self._ask_map)
        self.list = QPushButton(translate("history", "Table…"))
        self.list.setToolTip(translate("history", "the parts that were found, as CSV"))
        self.list.clicked.connect(self._ask_list)
        self.export = QPushButton(translate("history", "Export reviewed…"))
        bottom = QHBoxLayout()
        bottom.addWidget(self.comment, 1)
        for opinion, button in self.opinions.items():
            button.clicked.connect(lambda _=False, o=opinion: self.say(o))
            bottom.addWidget(button)
        self.export.clicked.connect(self._ask_export)
        for button in (self.show_map, self.list, self.export):
            bottom.addWidget(button)
        rows = QVBoxLayout(self)
        rows.addLayout(top)
        rows.addWidget(split, 1)
        rows.addWidget(self._reviewed)
        rows.addLayout(bottom)
        rows.addWidget(self._work)
        rows.addWidget(self._problem)

    def search(self) -> None:
        """Read the index."""
        try:
            rows, known = self.fields.search(self._session.received.folder)
        except RecordError as error:
            rows, known = [], {}
            self._problem.setText(str(error))
        else:
            self._problem.setText("")
        last = self._session.received.last
        self._seen = 0 if last is None else last.record.inspection_id
        self._pictures = {row.inspection_id: self._pictures[row.inspection_id] for row in rows if row.inspection_id in self._pictures}
        self.film.fill(rows, {**self._pictures, **self._session.received.thumbs}, known)
        more, parts = translate("history", "the newest 300") if len(rows) == FOUND else "", translate("history", "parts")
        self._count.setText(f"{len(rows)} {parts}  {more}")
        if self.film.chosen() is None and rows:
            self.film.setCurrentRow(0)
        elif not rows:
            self._on_chosen()
        if self.gallery.isChecked():
            self._read_pictures(rows)

    def open_part(self, number: int) -> None:
        """Choose a part, whatever was looked for."""
        self.fields.clear()
        self.search()
        if number not in self.film.rows:
            older = find(self._session.received.folder, Wanted(number=number))
            self.film.fill([*older, *self.film.rows.values()], self._session.received.thumbs, self._reviews())
        self.film.setCurrentRow(list(self.film.rows).index(number) if number in self.film.rows else -1)

    def _follow(self) -> None:
        """Add new parts automatically, but not while somebody looks further down."""
        last = self._session.received.last
        newer = last is not None and last.record.inspection_id != self._seen
        if newer and self.isVisible() and not self._work.busy and self.film.verticalScrollBar().value() == 0:
            self.search()

    def _on_chosen(self) -> None:
        number = self.film.chosen()
        row = None if number is None else self.film.rows.get(number)
        if row is None:
            self.record.show_nothing()
        else:
            self.record.show_row(self._session.received.folder, row)
        self._on_user()

    def _on_user(self) -> None:
        """Who may say what of the chosen part, and what was said."""
        number = self.film.chosen()
        self._review = None if number is None else self._reviews().get(number)
        self._look()

    def _look(self) -> None:
        number, user, review = self.film.chosen(), self._session.account.user, self._review
        row = None if number is None else self.film.rows.get(number)
        for opinion, button in self.opinions.items():
            where = opinion is not Opinion.MISSED or bool(self.record.marks)
            allowed = user is not None and not self._waiting and where
            button.setEnabled(allowed and row is not None and opinion in possible(row.verdict))
        for button in (self.export, self.list):
            button.setEnabled(user is not None)
        self.show_map.setEnabled(row is not None and self.record.strip_shown)
        if row is None:
            self._reviewed.setText("")
            return
        state = data(review.state if review else State.NONE)
        said = ", ".join(f"{who}: {data(opinion)}" for who, opinion in review.opinions.items()) if review else ""
        missed = user is not None and row.verdict == Verdict.OK and not self.record.marks
        hint = translate("history", "log in to review") if user is None else ""
        hint = translate("history", "touch the cells in which a defect was missed") if missed else hint
        self._reviewed.setText(" · ".join(text for text in (state, said, hint) if text))

    def _reviews(self) -> dict[int, Review]:
        """All reviews; if they cannot be read, that is said."""
        try:
            return reviews(self._session.received.folder)
        except RecordError as error:
            self._problem.setText(str(error))
            return {}

    def say(self, opinion: Opinion) -> None:
        """Whoever is logged in says it of the chosen part."""
        number = self.film.chosen()
        if number is None:
            return
        marks = self.record.marks if opinion is Opinion.MISSED else {}
        self._waiting = True
        self._look()
        self._session.account.ask(GiveReview(number, opinion, self.comment.text().strip(), dict(marks)), self._on_said, self)

    def _on_said(self, answer: Answer) -> None:
        self._waiting = False
        if answer.done:
            self.comment.clear()
            self.record.clear_marks()
            self.search()
        else:
            self._problem.setText(data(answer.refusal))
        self._on_user()

    def _on_gallery(self, gallery: bool) -> None:
        self.film.as_gallery(gallery)
        self.search()

    def _read_pictures(self, rows: list[Row]) -> None:
        folder, known = self._session.received.folder, {**self._pictures, **self._session.received.thumbs}
        missing = [r for r in rows[:GALLERY] if r.inspection_id not in known]
        if missing and not self._work.busy:
            self._work.start(
                translate("history", "pictures"),
                lambda progress: small_pictures(folder, missing, progress),
                self._on_pictures,
            )

    def _on_pictures(self, found: dict[int, QImage]) -> None:
        self._pictures |= found
        pictures = {**self._pictures, **self._session.received.thumbs}
        self.film.fill(list(self.film.rows.values()), pictures, self._reviews())

    def _on_map(self, made: tuple[int, QImage]) -> None:
        number, overlay = made
        shown = self.record.record
        if shown is not None and shown.inspection_id == number:  # or another part was chosen meanwhile
            self.record.strip.show_map(overlay)

    def _ask_export(self) -> None:
        folder = ask_folder(self, self._session, translate("history", "Folder for the crops of reviewed parts"))
        if folder is not None:
            self.export_to(folder / "reviewed")

    def _ask_list(self) -> None:
        path = ask_file(self, self._session, translate("history", "the parts that were found, as CSV"), "parts.csv")
        if path is not None:
            self.list_to(path)

    def list_to(self, target: Path) -> None:
        """Write the parts in the list as a table next to the window, one row each."""
        folder, numbers = self._session.received.folder, list(self.film.rows)

        def work(progress: Progress) -> str | None:
            entries = _read(folder, numbers, progress)
            if entries is None:
                return None
            with replacing(target) as part:  # the dialog has asked
                problems = list(export(entries, folder, part, "csv"))
            return f"{target}: {len(entries) - len(problems)}"

        self._work.start(translate("history", "table"), work, self._said.setText)

    def _ask_map(self) -> None:
        record, settings = self.record.record, self._session.received.settings
        if record is not None:
            title = translate("history", "defect map")
            self._work.start(title, lambda _: defect_map(settings, record), self._on_map)

    def export_to(self, target: Path) -> None:
        """Write the crops of the parts that two people agree on next to the window."""
        folder = self._session.received.folder

        def work(progress: Progress) -> str | None:
            agreed = [number for number, review in reviews(folder).items() if review.agreed is not None]
            entries = _read(folder, agreed, progress)
            if entries is None:
                return None
            done, of = iter(range(len(entries))), len(entries)
            problems = list(export(entries, folder, target, "reviewed", lambda: progress(next(done, 0), of)))
            parts, left_out = translate("history", "parts"), translate("history", "left out")
            return f"{target}: {len(entries) - len(problems)} {parts}, {len(problems)} {left_out}"

        self._work.start(translate("history", "export"), work, self._said.setText)

    def close_page(self) -> None:
        """Stop timer and work."""
        self._timer.stop()
        self._work.close_work()


def _read(folder: Path, numbers: Sequence[int], progress: Progress) -> list[Listed] | None:
    """Return the records of these numbers; None if cancelled."""
    entries: list[Listed] = []
    for count, number in enumerate(numbers):
        if not progress(count, len(numbers)):
            return None
        entries += read_records(folder, Wanted(number=number))
    return entries
