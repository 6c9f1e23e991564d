"""Judges images of this archive or of a folder again and shows the verdicts next to those of the line."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QSplitter, QVBoxLayout, QWidget

from station.domain import Verdict
from station.files.image import read_image
from station.inspection.inspector import Inspector
from station.inspection.loading import load_inspector
from station.journal.users import Level
from station.panel.look.words import data, translate
from station.panel.pages.page import Page
from station.panel.session.session import Session
from station.panel.widgets.card import Choice, Table, label, titled
from station.panel.widgets.dialogs import ask_folder
from station.panel.widgets.field import NumberField
from station.panel.widgets.weld.kept import judged
from station.panel.widgets.weld.weld_view import Drawn, WeldView
from station.panel.widgets.work import Progress, WorkBar
from station.records import Provenance
from station.replay.compare import Comparison, compare
from station.replay.files import Source, sources
from station.replay.judge import at_scale
from station.replay.replayed import Replayed
from station.replay.report import write_page
from station.replay.results import write_json
from station.replay.run import replay
from station.settings.model import Settings, for_recipe

NEWEST = (20, 100, 500)
"""Numbers of frames of this archive to choose from."""


@dataclass(frozen=True, slots=True)
class Done:
    """One finished replay."""

    sources: tuple[Source, ...]
    results: dict[str, Replayed]
    """By the name of the image."""
    judge: tuple[Inspector, Provenance]
    factor: float
    comparison: Comparison | None
    problems: tuple[str, ...]


class ReplayPage(Page):
    """Judges on one thread next to the window, in the time that the engine leaves; independent of the PLC."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.done: Done | None = None
        self._lay_out()
        self.judge.clicked.connect(self.start)
        self.choose.clicked.connect(self._ask_folder)
        self.report.clicked.connect(self._ask_report)
        self.only_flips.toggled.connect(self._fill)
        self.table.itemSelectionChanged.connect(self._on_chosen)
        for work in (self._work, self._looking):
            work.failed.connect(lambda why: self._problem.setText(data(why)))
        session.account.changed.connect(self._on_user)
        self._on_user()

    def _lay_out(self) -> None:
        self.what, self.folder, self.recipe = Choice(), QLineEdit(), Choice()
        newest = translate("replay", "the newest of this station:")
        for count in NEWEST:
            self.what.addItem(f"{newest} {count}", count)
        self.what.addItem(translate("replay", "a folder or another archive:"), None)
        self.choose = QPushButton(translate("replay", "Choose…"))
        self.folder.setPlaceholderText(translate("replay", "folder with images"))
        word = translate("replay", "recipe")
        for number in sorted({1, *self._session.received.settings.recipes}):
            self.recipe.addItem(f"{word} {number}", number)
        self.scale = NumberField(1.0, 200.0, "µm/px")
        self.scale.set(self._session.received.settings.weld.um_per_px)
        self.judge, self.report = (
            QPushButton(translate("replay", "Judge")),
            QPushButton(translate("replay", "Report…")),
        )
        self.only_flips = QPushButton(translate("replay", "Flipped verdicts only"))
        self.only_flips.setCheckable(True)
        top, second = QHBoxLayout(), QHBoxLayout()
        for widget, stretch in ((self.what, 0), (self.folder, 1), (self.choose, 0)):
            top.addWidget(widget, stretch)
        for part in (self.recipe, label(translate("replay", "scale of the images"), "quiet"), self.scale):
            second.addWidget(part)
        second.addStretch(1)
        for button in (self.judge, self.only_flips, self.report):
            second.addWidget(button)
        self.said, self._problem, self._work = (
            label("", "title", wrap=True),
            label("", "problem", wrap=True),
            WorkBar(),
        )
        heads = (
            translate("replay", "image"),
            translate("replay", "on the line"),
            translate("replay", "now"),
            translate("replay", "score"),
            translate("replay", "reason"),
        )
        self.table, self.weld, self._looking = Table(heads, stretch=0), WeldView(), WorkBar()
        policy = self._looking.sizePolicy()
        policy.setRetainSizeWhenHidden(True)  # the image does not jump
        self._looking.setSizePolicy(policy)
        right = QWidget()
        column = QVBoxLayout(right)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.weld, 1)
        column.addWidget(self._looking)
        split = QSplitter()
        split.addWidget(titled(translate("replay", "images"), self.table))
        split.addWidget(right)
        split.setSizes([640, 440])
        rows = QVBoxLayout(self)
        for line in (top, second):
            rows.addLayout(line)
        for place in (self.said, self._work, self._problem):
            rows.addWidget(place)
        rows.addWidget(split, 1)

    def _on_user(self) -> None:
        hint = (
            ""
            if self._session.account.may(Level.OPERATOR)
            else translate("replay", "log in first (page Setup)")
        )
        for button in (self.judge, self.choose, self.report):
            button.setEnabled(not hint)
            button.setToolTip(hint)
        self.report.setEnabled(not hint and self.done is not None)

    def _ask_folder(self) -> None:
        folder = ask_folder(self, self._session, translate("replay", "folder with images"))
        if folder is not None:
            self.folder.setText(str(folder))
            self.what.setCurrentIndex(self.what.count() - 1)

    def start(self) -> None:
        """Judge the images that the fields name."""
        scale, count, text = self.scale.value, self.what.currentData(), self.folder.text().strip()
        if scale is None:
            self._problem.setText(translate("replay", "the scale must be 1 to 200 µm/px"))
            return
        if count is None and not text:
            self._problem.setText(translate("replay", "choose a folder first"))
            return
        settings, number = self._session.received.settings, int(self.recipe.currentData())
        path = self._session.received.folder if count is not None else Path(text)

        def work(progress: Progress) -> Done | None:
            return _judged(for_recipe(settings, number), path, count, um_per_px=scale, progress=progress)

        self._problem.setText("")
        if self._work.start(translate("replay", "images are judged"), work, self._on_done):
            self.done = None
            self.said.setText("")
            self.weld.show_weld(None)
            self._fill()
            self._on_user()

    def _on_done(self, found: Done) -> None:
        self.done = found
        self._summarise(found)
        self._fill()
        self._on_user()

    def _on_report(self, page: str) -> None:
        self._problem.setText("")
        self.said.setText(page)

    def _on_picture(self, seen: tuple[str, Drawn]) -> None:
        name, drawn = seen
        if name == self.table.chosen():
            self.weld.show_weld(drawn, caption=name)
        else:  # another image was chosen meanwhile
            self._on_chosen()

    def _summarise(self, found: Done) -> None:
        counts = Counter(replayed.verdict for replayed in found.results.values())
        text = translate("replay", "{n} images: {ok} OK, {nok} NOK, {error} not judged").format(
            n=len(found.results), ok=counts[Verdict.OK], nok=counts[Verdict.NOK], error=counts[Verdict.ERROR]
        )
        c = found.comparison
        if c is not None:
            text += "; " + translate("replay", "{n} compared with the line, {flips} verdicts differ").format(
                n=c.compared, flips=len(c.flips)
            )
        self.said.setText(text)
        problems = list(found.problems)
        if c is not None:
            unlike = translate("replay", "differs from its record, although networks and limits are the same")
            problems += [*c.problems, *(f"{name}: {unlike}" for name in c.not_alike)]
        more = translate("replay", "and {n} more").format(n=len(problems) - 3)
        self._problem.setText("\n".join([*problems[:3], *([more] if len(problems) > 3 else [])]))

    def _fill(self) -> None:
        if self.done is None:
            self.table.fill(())
            return
        flips = () if self.done.comparison is None else self.done.comparison.flips
        before = {flip.name: flip.before for flip in flips}
        rows, names = [], []
        for source in self.done.sources:
            replayed, flipped = self.done.results[source.name], before.get(source.name)
            if self.only_flips.isChecked() and flipped is None:
                continue
            line = "–" if source.row is None else source.row.verdict
            mark = "≠ " if flipped is not None else ""
            score = "–" if replayed.worst is None else f"{replayed.worst:.3f}"
            reason = "" if replayed.reason is None else data(replayed.reason)
            rows.append((source.name, line, f"{mark}{replayed.verdict}", score, reason))
            names.append(source.name)
        self.table.fill(rows, names)

    def _on_chosen(self) -> None:
        """Show the chosen image with what is found in it now."""
        found, name = self.done, self.table.chosen()
        if found is None or name is None or self._looking.busy:
            return
        path = next(source.path for source in found.sources if source.name == name)

        def work(_progress: Progress) -> tuple[str, Drawn]:
            image, inspector = at_scale(read_image(path), found.factor), found.judge[0]
            inspection = inspector.inspect(image)
            return str(name), judged(image, inspection)[0]

        self._looking.start("", work, self._on_picture)

    def _ask_report(self) -> None:
        folder = ask_folder(self, self._session, translate("replay", "folder for the report"))
        if folder is not None:
            self.write_report(folder / "weldgate-replay")

    def write_report(self, folder: Path) -> None:
        """Write report.html with images, and replay.json, next to the window."""
        found = self.done
        if found is None:
            return

        def work(_progress: Progress) -> str:
            page = write_page(
                folder,
                sources=found.sources,
                results=found.results,
                judge=found.judge[1],
                comparison=found.comparison,
                truth=None,
                problems=found.problems,
            )
            write_json(folder / "replay.json", found.results.values())
            return str(page)

        self._work.start(translate("replay", "report"), work, self._on_report)

    def close_page(self) -> None:
        """Stop the work."""
        for work in (self._work, self._looking):
            work.close_work()


def _judged(
    settings: Settings,
    path: Path,
    count: int | None,
    *,
    um_per_px: float,
    progress: Progress,
) -> Done | None:
    """Judge the newest `count` images below a path, or all; None if cancelled. Raises WeldgateError."""
    found = sources([path])
    if count is not None:
        found = found[-count:]
    one = settings.model_copy(
        update={"model": settings.model.model_copy(update={"threads": 1, "reference_path": None})}
    )
    judge, factor = load_inspector(one), um_per_px / settings.weld.um_per_px
    results: dict[str, Replayed] = {}
    problems: list[str] = []
    for replayed in replay(found, one, judge=judge, factor=factor, processes=1, part=None):
        results[replayed.name] = replayed
        problems += [*([replayed.problem] if replayed.problem else []), *replayed.warnings]
        if not progress(len(results), len(found)):
            return None
    recorded = any(source.row is not None for source in found)
    comparison = compare(found, results, judge[1]) if recorded else None
    return Done(tuple(found), results, judge, factor, comparison, tuple(problems))
