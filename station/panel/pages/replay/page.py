"""The page Replay: judges recorded images again and compares the verdicts with those of the line."""

from collections import Counter
from pathlib import Path

from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QSplitter, QVBoxLayout, QWidget

from station.domain import TRAINED_UM_PER_PX, Verdict
from station.files.image import read_image
from station.journal.users import Level
from station.panel.look.words import data, translate
from station.panel.pages.page import Page
from station.panel.pages.replay.judging import Done, judge_images
from station.panel.session.session import Session
from station.panel.widgets.card import Choice, Table, label, titled
from station.panel.widgets.dialogs import ask_folder
from station.panel.widgets.field import NumberField
from station.panel.widgets.progress import Progress
from station.panel.widgets.weld.recorded import judged
from station.panel.widgets.weld.weld_view import Drawn, WeldView
from station.panel.widgets.work import WorkBar
from station.replay.report import write_page
from station.replay.results import write_json
from station.settings.model import for_recipe

NEWEST = (20, 100, 500)
"""Numbers of frames of this archive to choose from."""


class ReplayPage(Page):
    """Judges on one thread next to the window, in the time that the engine leaves, without the PLC."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.done: Done | None = None
        self._lay_out()
        self.judge.clicked.connect(self.start)
        self.choose.clicked.connect(self._ask_folder)
        self.recipe.currentIndexChanged.connect(self._on_recipe)
        self.report.clicked.connect(self._ask_report)
        self.only_flips.toggled.connect(self._fill)
        self.table.itemSelectionChanged.connect(self._on_chosen)
        for work in (self.work, self._chosen_work):
            work.failed.connect(lambda why: self.problem.setText(data(why)))
        session.account.changed.connect(self._on_user)
        self._on_user()

    def _lay_out(self) -> None:
        self.what, self.folder, self.recipe = Choice(), QLineEdit(), Choice()
        newest = translate("replay", "newest of this station:")
        for count in NEWEST:
            self.what.addItem(f"{newest} {count}", count)
        self.what.addItem(translate("replay", "folder or another archive:"), None)
        self.choose = QPushButton(translate("replay", "Choose…"))
        self.folder.setPlaceholderText(translate("replay", "folder with images"))
        word = translate("replay", "recipe")
        for number in sorted({1, *self._session.received.settings.recipes}):
            self.recipe.addItem(f"{word} {number}", number)
        self.scale = NumberField(*TRAINED_UM_PER_PX, "µm/px")
        self._on_recipe()
        self.judge, self.report = (
            QPushButton(translate("replay", "Judge")),
            QPushButton(translate("replay", "Report…")),
        )
        self.only_flips = QPushButton(translate("replay", "Changed verdicts only"))
        self.only_flips.setCheckable(True)
        top, second = QHBoxLayout(), QHBoxLayout()
        for place, stretch in ((self.what, 0), (self.folder, 1), (self.choose, 0)):
            top.addWidget(place, stretch)
        for widget in (self.recipe, label(translate("replay", "scale of the images"), "quiet"), self.scale):
            second.addWidget(widget)
        second.addStretch(1)
        for button in (self.judge, self.only_flips, self.report):
            second.addWidget(button)
        self.message, self.problem, self.work = (
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
        self.table, self.weld, self._chosen_work = Table(heads, stretch=0), WeldView(), WorkBar()
        policy = self._chosen_work.sizePolicy()
        policy.setRetainSizeWhenHidden(True)  # the image does not jump
        self._chosen_work.setSizePolicy(policy)
        right = QWidget()
        column = QVBoxLayout(right)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.weld, 1)
        column.addWidget(self._chosen_work)
        split = QSplitter()
        split.addWidget(titled(translate("replay", "images"), self.table))
        split.addWidget(right)
        split.setSizes([640, 440])
        rows = QVBoxLayout(self)
        for line in (top, second):
            rows.addLayout(line)
        for row in (self.message, self.work, self.problem):
            rows.addWidget(row)
        rows.addWidget(split, 1)

    def _on_user(self) -> None:
        hint = (
            ""
            if self._session.account.may(Level.OPERATOR)
            else translate("replay", "Log in first (page Setup).")
        )
        for button in (self.judge, self.choose, self.report):
            button.setEnabled(not hint)
            button.setToolTip(hint)
        self.report.setEnabled(not hint and self.done is not None)

    def _on_recipe(self) -> None:
        settings, number = self._session.received.settings, int(self.recipe.currentData())
        self.scale.set(for_recipe(settings, number).weld.um_per_px)

    def _ask_folder(self) -> None:
        folder = ask_folder(self, self._session, translate("replay", "folder with images"))
        if folder is not None:
            self.folder.setText(str(folder))
            self.what.setCurrentIndex(self.what.count() - 1)

    def start(self) -> None:
        """Judge the images that the fields name."""
        scale, count, text = self.scale.value, self.what.currentData(), self.folder.text().strip()
        if scale is None:
            text = translate("replay", "The scale must be {low} to {high} µm/px.")
            low, high = TRAINED_UM_PER_PX
            self.problem.setText(text.format(low=f"{low:g}", high=f"{high:g}"))
            return
        if count is None and not text:
            self.problem.setText(translate("replay", "Choose a folder first."))
            return
        settings, number = self._session.received.settings, int(self.recipe.currentData())
        path = self._session.received.folder if count is not None else Path(text)

        def work(progress: Progress) -> Done | None:
            return judge_images(for_recipe(settings, number), path, count, um_per_px=scale, progress=progress)

        self.problem.setText("")
        if self.work.start(translate("replay", "Judging images"), work, self._on_done):
            self.done = None
            self.message.setText("")
            self.weld.show_weld(None)
            self._fill()
            self._on_user()

    def _on_done(self, found: Done) -> None:
        self.done = found
        self._summarise(found)
        self._fill()
        self._on_user()

    def _on_report(self, page: str) -> None:
        self.problem.setText("")
        self.message.setText(page)

    def _on_image(self, shown: tuple[str, Drawn]) -> None:
        name, drawn = shown
        if name == self.table.chosen():
            self.weld.show_weld(drawn, caption=name)
        else:  # another image was chosen meanwhile
            self._on_chosen()

    def _summarise(self, found: Done) -> None:
        counts = Counter(replayed.verdict for replayed in found.results.values())
        text = translate("replay", "{n} images: {ok} OK, {nok} NOK, {error} not judged").format(
            n=len(found.results), ok=counts[Verdict.OK], nok=counts[Verdict.NOK], error=counts[Verdict.ERROR]
        )
        comparison = found.comparison
        if comparison is not None:
            text += "; " + translate("replay", "{n} compared with the line, {flips} verdicts differ").format(
                n=comparison.compared, flips=len(comparison.flips)
            )
        self.message.setText(text)
        problems = list(found.problems)
        if comparison is not None:
            unlike = translate(
                "replay", "not reproducible: same networks and limits give another result than on the line"
            )
            problems += [*comparison.problems, *(f"{name}: {unlike}" for name in comparison.not_alike)]
        more = translate("replay", "and {n} more").format(n=len(problems) - 3)
        self.problem.setText("\n".join([*problems[:3], *([more] if len(problems) > 3 else [])]))

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
            texts = ("" if replayed.reason is None else data(replayed.reason), replayed.detail or "")
            reason = ": ".join(text for text in texts if text)
            rows.append((source.name, line, f"{mark}{replayed.verdict}", score, reason))
            names.append(source.name)
        self.table.fill(rows, names)

    def _on_chosen(self) -> None:
        """Show the chosen image with what is found in it now."""
        found, name = self.done, self.table.chosen()
        if found is None or name is None or self._chosen_work.busy:
            return
        path = next(source.path for source in found.sources if source.name == name)

        def work(_progress: Progress) -> tuple[str, Drawn]:
            image, inspector = read_image(path), found.judge[0]
            inspection = inspector.inspect(image)
            return str(name), judged(image, inspection, um_per_px=inspector.um_per_px)[0]

        self._chosen_work.start("", work, self._on_image)

    def _ask_report(self) -> None:
        folder = ask_folder(self, self._session, translate("replay", "Folder for the report"))
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

        self.work.start(translate("replay", "Writing the report"), work, self._on_report)

    def close_page(self) -> None:
        """Stop the work."""
        for bar in (self.work, self._chosen_work):
            bar.close_work()
