"""The tab Recipe: limits of a recipe.

They can be saved, with a reason, once a what-if has shown how they would have changed the verdicts of
the archive.
"""

from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QLineEdit, QPushButton, QVBoxLayout, QWidget

from station.analysis.what_if import WhatIf, what_if
from station.channel.requests import Changed
from station.classify.onnx import Classifier
from station.defects import KINDS
from station.errors import ModelError, SettingsError
from station.journal.users import Level
from station.panel.look.words import data, translate
from station.panel.pages.page import Page
from station.panel.pages.setup.limit_fields import (
    FIELDS,
    MIN_MM,
    THRESHOLD,
    limits_in_use,
    place_of,
    quality_of,
    thresholds_of,
)
from station.panel.pages.setup.what_if_notes import notes
from station.panel.pages.setup.what_if_state import Missing, Values, WhatIfState, scored_records
from station.panel.session.session import Session
from station.panel.widgets.card import Choice, Table, label, titled
from station.panel.widgets.field import NumberField, SegmentLimits
from station.panel.widgets.progress import Progress
from station.panel.widgets.work import WorkBar
from station.settings.model import for_recipe


class RecipePage(Page):
    """Shows and changes thresholds, minimum lengths and limits of the image quality."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self._state = WhatIfState()
        self._saving = False
        """True while the engine has not answered to a change that was made here."""
        self.recipe = Choice()
        word = translate("recipe", "recipe")
        for number in sorted({1, *session.received.settings.recipes}):
            self.recipe.addItem(f"{word} {number}", number)
        threshold, length = (
            translate("recipe", "{kind}: threshold"),
            translate("recipe", "{kind}: minimum length (mm)"),
        )
        names = {
            **{THRESHOLD.format(kind.name): threshold.format(kind=data(kind.reason)) for kind in KINDS},
            **{MIN_MM.format(kind.name): length.format(kind=data(kind.reason)) for kind in KINDS},
            "min_mean_dn": translate("recipe", "minimum brightness"),
            "max_dark_share": translate("recipe", "maximum dark fraction"),
            "max_saturated_share": translate("recipe", "maximum saturated fraction"),
            "min_sharpness": translate("recipe", "minimum sharpness"),
        }
        self.fields = {key: NumberField(low, high) for key, (_, low, high) in FIELDS.items()}
        self._names: dict[str, QLabel] = {}
        self.segments = SegmentLimits()
        self.segments.changed.connect(self._refresh_buttons)
        heads = (
            translate("recipe", "part"),
            translate("recipe", "serial"),
            translate("recipe", "before"),
            translate("recipe", "after"),
            translate("recipe", "segment"),
            translate("recipe", "score"),
        )
        self.released, self.rejected = Table(heads, stretch=1), Table(heads, stretch=1)
        self.ask, self.save = (
            QPushButton(translate("recipe", "What if?")),
            QPushButton(translate("recipe", "Save")),
        )
        self.reason = QLineEdit()
        self.reason.setPlaceholderText(translate("recipe", "reason (required)"))
        self.message, self.problem, self._work = (
            label("", "title"),
            label("", "problem", wrap=True),
            WorkBar(),
        )
        box = QWidget()
        form = QGridLayout(box)
        form.setVerticalSpacing(2)
        form.addWidget(self.recipe, 0, 0, 1, 2)
        for place, (key, name) in enumerate(names.items(), 1):
            self._names[key] = label(name)
            form.addWidget(self._names[key], place, 0)
            form.addWidget(self.fields[key], place, 1)
            self.fields[key].changed.connect(self._refresh_buttons)
        form.addWidget(label(translate("recipe", "thresholds of single segments")), len(names) + 1, 0)
        form.addWidget(self.segments, len(names) + 1, 1)
        right = QVBoxLayout()
        right.addWidget(self.message)
        right.addWidget(
            titled(translate("recipe", "released parts (NOK → OK): possible escapes"), self.released), 1
        )
        right.addWidget(
            titled(translate("recipe", "rejected parts (OK → NOK): possible false rejects"), self.rejected), 1
        )
        below = QHBoxLayout()
        for widget, stretch in ((self.ask, 0), (self.reason, 1), (self.save, 0)):
            below.addWidget(widget, stretch)
        right.addLayout(below)
        right.addWidget(self._work)
        right.addWidget(self.problem)
        left = QVBoxLayout()
        left.addWidget(titled(translate("recipe", "limits"), box))
        left.addStretch(1)
        row = QHBoxLayout(self)
        row.addLayout(left, 2)
        row.addLayout(right, 3)
        self.ask.clicked.connect(self._ask)
        self.save.clicked.connect(self._save)
        self.reason.textChanged.connect(self._refresh_buttons)
        self.recipe.currentIndexChanged.connect(self._fill)
        self._work.failed.connect(self.problem.setText)
        session.account.changed.connect(self._on_user)
        session.received.settings_changed.connect(self._on_settings)
        session.change.used.connect(self._on_used)
        session.change.refused.connect(self._on_refused)
        session.change.asked.connect(self._refresh_buttons)

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        """Load the limits when they are first shown: those of a model are in its file."""
        if self._state.in_use is None:
            self._fill()
        super().showEvent(event)

    def _on_settings(self) -> None:
        if self._state.in_use is not None:
            self._fill()

    def _fill(self) -> None:
        """Show the limits in use."""
        number = int(self.recipe.currentData())
        settings = for_recipe(self._session.received.settings, number)
        try:
            self._state.in_use = Values(
                number, limits_in_use(settings), dict(settings.model.segment_thresholds)
            )
        except (ModelError, SettingsError) as error:
            self.problem.setText(str(error))
            return
        self.segments.set(self._state.in_use.segments)
        for key, field in self.fields.items():
            known = key in self._state.in_use.limits
            if known:
                field.set(self._state.in_use.limits[key])
            for widget in (field, self._names[key]):
                widget.setVisible(known)
        self._refresh_buttons()

    def values(self) -> Values | None:
        """Return the limits in the fields, or None if one of them is not allowed."""
        used = self._state.in_use
        keys = FIELDS if used is None else used.limits
        numbers = {key: value for key in keys if (value := self.fields[key].value) is not None}
        segments = self.segments.value
        return (
            None
            if len(numbers) < len(keys) or segments is None
            else Values(int(self.recipe.currentData()), numbers, segments)
        )

    def _on_user(self) -> None:
        """Forget what was typed and asked: another user is logged in, or none."""
        self._work.cancel()
        self._saving = False
        self.reason.clear()
        self._forget()
        self._refresh_buttons()

    def _forget(self) -> None:
        """Remove the what-if that is shown."""
        self._state.asked = None
        self.message.setText("")
        for table in (self.released, self.rejected):
            table.fill(())

    def _refresh_buttons(self) -> None:
        values = self.values()
        if self._state.asked is not None and values != self._state.asked:
            self._forget()
        changed = self._state.changed(values)
        self.ask.setEnabled(changed and not self._work.busy)
        session = self._session
        missing = self._state.missing(
            values, self.reason.text(), session.account.may(Level.QUALITY), session.change.waiting
        )
        self.save.setEnabled(missing is Missing.NOTHING)
        hints = {
            Missing.LOGIN: translate("recipe", "Log in as quality to save."),
            Missing.QUESTION: translate("recipe", "Run the what-if before saving."),
            Missing.REASON: translate("recipe", "A reason is required."),
            Missing.ANSWER: translate("recipe", "Waiting for the engine..."),
        }
        self.save.setToolTip(hints.get(missing, ""))

    def _ask(self) -> None:
        values, folder = self.values(), self._session.received.folder
        if values is None:
            return
        settings = for_recipe(self._session.received.settings, values.recipe)
        thresholds, quality = thresholds_of(values), quality_of(values, settings)

        def work(progress: Progress) -> tuple[Values, WhatIf, int] | None:
            card = Classifier(settings.model.path, 1).card
            found = scored_records(folder, values.recipe, card.file_hash, progress)
            if found is None:
                return None
            limit, novel = card.novelty_limit, settings.model.novel
            asked = what_if(found[0], thresholds, quality, novelty_limit=limit, novel=novel)
            return values, asked, found[1]

        self._work.start(translate("recipe", "Judging the archive again"), work, self._on_done)
        self._refresh_buttons()

    def _on_done(self, result: tuple[Values, WhatIf, int]) -> None:
        values, found, left_out = result
        if values != self.values():
            self._refresh_buttons()
            return
        self._state.asked = values
        for table, flips in ((self.released, found.released), (self.rejected, found.rejected)):
            rows = [
                (
                    str(flip.inspection_id),
                    flip.serial,
                    str(flip.before),
                    str(flip.after),
                    str(flip.segment),
                    f"{flip.score:.3f}",
                )
                for flip in flips
            ]
            table.fill(rows)
        self.message.setText(
            translate("recipe", "{n} parts: {released} would be released, {rejected} rejected").format(
                n=found.compared, released=len(found.released), rejected=len(found.rejected)
            )
        )
        self.problem.setText(notes(found, left_out))
        self._refresh_buttons()

    def _save(self) -> None:
        values, used = self.values(), self._state.in_use
        if values is None or used is None:
            return
        before = used.rounded().limits
        changes: list[Changed] = []
        for key, value in values.limits.items():
            if value != before[key]:
                changes.append(Changed(place_of(key, values.recipe), value, used.limits[key]))
        if values.segments != used.segments:
            changes.append(
                Changed(
                    ("recipes", str(values.recipe), "model", "segment_thresholds"),
                    values.segments,
                    used.segments,
                )
            )
        self._saving = True
        self.problem.setText("")
        self._forget()
        self.message.setText(translate("recipe", "Waiting for the engine..."))
        self._session.change.make(changes, self.reason.text())

    def _on_used(self) -> None:
        if self._saving:
            self._saving = False
            self.reason.clear()
            self._fill()
            self.message.setText(translate("recipe", "Saved and in use."))
        self._refresh_buttons()

    def _on_refused(self, why: str) -> None:
        if self._saving:
            self._saving = False
            self._fill()
            self.message.setText("")
            nothing = translate("recipe", "Nothing was changed:")
            self.problem.setText(f"{nothing} {data(why)}")
        self._refresh_buttons()

    def close_page(self) -> None:
        """Stop the work."""
        self._work.close_work()
