"""Limits of a recipe: what they would have done to the parts of the archive is shown before they can be saved, with a reason."""

from dataclasses import dataclass, replace

from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLineEdit, QPushButton, QVBoxLayout, QWidget

from station.archive.reader import Wanted, find, read_words
from station.archive.whatif import WhatIf, what_if
from station.classify.onnx import Classifier
from station.classify.thresholds import Limit, Thresholds, in_use
from station.defects import KINDS
from station.errors import ModelError, SettingsError, WeldgateError
from station.panel.card import Choice, Table, label, titled
from station.panel.page import Page
from station.panel.session import Session
from station.panel.setup.change import MIN_REASON, change
from station.panel.setup.field import NumberField, SegmentLimits
from station.panel.words import data, translate
from station.panel.work import Told, WorkBar
from station.records import Record
from station.settings import Settings, for_recipe
from station.users import Level

PARTS = 5000
"""The newest parts that are scored again."""
FIELDS = {
    **{f"limits.{kind.name}.threshold": ("model", 0.01, 0.99) for kind in KINDS},
    **{f"limits.{kind.name}.min_mm": ("model", 0.0, 5.0) for kind in KINDS},
    "min_mean_dn": ("quality", 0.0, 255.0),
    "max_dark_share": ("quality", 0.0, 1.0),
    "max_saturated_share": ("quality", 0.0, 1.0),
    "min_sharpness": ("quality", 0.0, 10.0),
}


@dataclass(frozen=True, slots=True)
class Values:
    """What stands in the fields."""

    recipe: int
    limits: dict[str, float]
    """By key."""
    segments: dict[int, float]
    """By number."""


class RecipePage(Page):
    """Thresholds and limits of picture quality."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self._in_use: Values | None = None
        self._asked: Values | None = None
        """Values of the what-if that is shown."""
        self.recipe = Choice()
        word = translate("recipe", "recipe")
        for number in sorted({1, *session.settings.recipes}):
            self.recipe.addItem(f"{word} {number}", number)
        threshold, length = translate("recipe", "{kind}: threshold"), translate("recipe", "{kind}: minimum length (mm)")
        names = {
            **{f"limits.{kind.name}.threshold": threshold.format(kind=data(kind.reason)) for kind in KINDS},
            **{f"limits.{kind.name}.min_mm": length.format(kind=data(kind.reason)) for kind in KINDS},
            "min_mean_dn": translate("recipe", "least brightness"),
            "max_dark_share": translate("recipe", "greatest dark share"),
            "max_saturated_share": translate("recipe", "greatest saturated share"),
            "min_sharpness": translate("recipe", "least sharpness"),
        }
        self.fields = {key: NumberField(low, high) for key, (_, low, high) in FIELDS.items()}
        self.segments = SegmentLimits()
        self.segments.changed.connect(self._look)
        heads = (
            translate("recipe", "part"),
            translate("recipe", "serial"),
            translate("recipe", "was"),
            translate("recipe", "would be"),
            translate("recipe", "segment"),
            translate("recipe", "score"),
        )
        self.released, self.refused = Table(heads, stretch=1), Table(heads, stretch=1)
        self.ask, self.save = QPushButton(translate("recipe", "What if?")), QPushButton(translate("recipe", "Save"))
        self.reason = QLineEdit()
        self.reason.setPlaceholderText(translate("recipe", "reason (needed)"))
        self.said, self.problem, self._work = label("", "title"), label("", "problem", wrap=True), WorkBar()
        box = QWidget()
        form = QGridLayout(box)
        form.setVerticalSpacing(2)
        form.addWidget(self.recipe, 0, 0, 1, 2)
        for place, (key, name) in enumerate(names.items(), 1):
            form.addWidget(label(name), place, 0)
            form.addWidget(self.fields[key], place, 1)
            self.fields[key].changed.connect(self._look)
        form.addWidget(label(translate("recipe", "limits of single segments")), len(names) + 1, 0)
        form.addWidget(self.segments, len(names) + 1, 1)
        right = QVBoxLayout()
        right.addWidget(self.said)
        right.addWidget(titled(translate("recipe", "would be released (NOK → OK): possible escapes"), self.released), 1)
        right.addWidget(titled(translate("recipe", "would be refused (OK → NOK): possible false calls"), self.refused), 1)
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
        self.reason.textChanged.connect(self._look)
        self.recipe.currentIndexChanged.connect(self._fill)
        self._work.done.connect(self._on_done)
        self._work.failed.connect(self.problem.setText)
        session.user_changed.connect(self._on_user)
        session.settings_changed.connect(self._on_settings)
        session.change_used.connect(self._on_used)
        session.change_refused.connect(self._on_refused)

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        """The limits of a model are in its file: loaded once they are looked at."""
        if self._in_use is None:
            self._fill()
        super().showEvent(event)

    def _on_settings(self) -> None:
        if self._in_use is not None:
            self._fill()

    def _fill(self) -> None:
        """The limits in use."""
        number = int(self.recipe.currentData())
        settings = for_recipe(self._session.settings, number)
        try:
            self._in_use = Values(number, _limits(settings), dict(settings.model.segment_thresholds))
        except (ModelError, SettingsError) as error:
            self.problem.setText(str(error))
            return
        self.segments.set(self._in_use.segments)
        for key, field in self.fields.items():
            field.set(self._in_use.limits[key])
        self._look()

    def values(self) -> Values | None:
        """What stands in the fields; None if something is not allowed."""
        numbers = {key: field.value for key, field in self.fields.items() if field.value is not None}
        segments = self.segments.value
        return None if len(numbers) < len(FIELDS) or segments is None else Values(int(self.recipe.currentData()), numbers, segments)

    def _on_user(self) -> None:
        """What one has typed and seen is not for the next."""
        self._work.cancel()
        self.reason.clear()
        self._forget()
        self._look()

    def _forget(self) -> None:
        """What other values would have done."""
        self._asked = None
        self.said.setText("")
        for table in (self.released, self.refused):
            table.fill(())

    def _look(self) -> None:
        values = self.values()
        if self._asked is not None and values != self._asked:
            self._forget()
        used = self._in_use
        changed = used is not None and values is not None and values != replace(used, limits=_rounded(used.limits))
        self.ask.setEnabled(changed and not self._work.busy)
        allowed = self._session.may(Level.QUALITY)
        self.save.setEnabled(changed and allowed and values == self._asked and len(self.reason.text().strip()) >= MIN_REASON)
        hints = (
            (not allowed, translate("recipe", "log in as quality to save")),
            (changed and values != self._asked, translate("recipe", "ask what if before saving")),
            (changed and len(self.reason.text().strip()) < MIN_REASON, translate("recipe", "a reason is needed")),
        )
        self.save.setToolTip(next((text for needed, text in hints if needed), ""))

    def _ask(self) -> None:
        values, folder = self.values(), self._session.folder
        if values is None:
            return
        new, settings = values.limits, for_recipe(self._session.settings, values.recipe)
        quality = settings.quality.model_copy(update={k: v for k, v in new.items() if FIELDS[k][0] == "quality"})
        limits = tuple(
            Limit(kind, new[f"limits.{kind.name}.threshold"], new[f"limits.{kind.name}.min_mm"])
            for kind in KINDS
            if f"limits.{kind.name}.threshold" in new
        )
        thresholds = Thresholds(limits, tuple(sorted(values.segments.items())))

        def work(told: Told) -> tuple[Values, WhatIf, int] | None:
            judge = Classifier(settings.model.path, 1).card.file_hash
            rows = find(folder, Wanted(recipe=values.recipe, newest_first=True, limit=PARTS))
            records = list[Record]()
            for count, row in enumerate(rows):
                if count % 20 == 0 and not told(count, len(rows)):
                    return None
                record, _ = read_words(folder, row)
                if record is not None and record.provenance.model_hash == judge:  # scores of another model say nothing
                    records.append(record)
            return values, what_if(records, thresholds, quality), len(rows) - len(records)

        self._work.start(translate("recipe", "scoring the archive again"), work)
        self._look()

    def _on_done(self, answer: object) -> None:
        if not isinstance(answer, tuple) or answer[0] != self.values():
            self._look()
            return
        self._asked, found, left_out = answer
        for table, flips in ((self.released, found.released), (self.refused, found.refused)):
            rows = [(str(f.inspection_id), f.serial, str(f.before), str(f.after), str(f.segment), f"{f.score:.3f}") for f in flips]
            table.fill(rows)
        self.said.setText(
            translate("recipe", "{n} parts: {released} would be released, {refused} refused").format(
                n=found.looked_at, released=len(found.released), refused=len(found.refused)
            )
        )
        unknown = translate("recipe", "{n} parts that were too poor would be judged: nobody knows how").format(n=found.unknown)
        none = translate("recipe", "no part of this recipe in the archive: nobody knows what the limits do")
        others = translate("recipe", "{n} parts of another model, or unreadable, were left out").format(n=left_out)
        known = [text for text, told in ((unknown, found.unknown), (others, left_out)) if told]
        self.problem.setText(none if not found.looked_at else "; ".join(known))
        self._look()

    def _save(self) -> None:
        values, used = self.values(), self._in_use
        if values is None or used is None:
            return
        recipe, before = str(values.recipe), _rounded(used.limits)
        new: dict[tuple[str, ...], tuple[object, object]] = {}
        for key, value in values.limits.items():
            if value != before[key]:
                new["recipes", recipe, FIELDS[key][0], *key.split(".")] = (used.limits[key], value)
        if values.segments != used.segments:
            new["recipes", recipe, "model", "segment_thresholds"] = (used.segments, values.segments)
        try:
            told = change(self._session, Level.QUALITY, new, self.reason.text())
        except WeldgateError as error:
            self.problem.setText(data(str(error)))
            return
        self.reason.clear()
        self.problem.setText("" if told else translate("recipe", "saved; no engine is there, it is used at the next start"))
        self._fill()
        self._forget()
        self.said.setText(translate("recipe", "saved; the station is about to use it") if told else "")

    def _on_used(self) -> None:
        if self.said.text() and self._asked is None:
            self.said.setText(translate("recipe", "saved and in use"))

    def _on_refused(self) -> None:
        self._fill()
        self.said.setText("")
        self.problem.setText(translate("recipe", "the station refused the change (see its log), it was taken back"))

    def close_page(self) -> None:
        """Nothing is left running."""
        self._work.close_work()


def _rounded(limits: dict[str, float]) -> dict[str, float]:
    """As the fields show them."""
    return {key: float(f"{value:.6g}") for key, value in limits.items()}


def _limits(settings: Settings) -> dict[str, float]:
    """Return the limits in use: of the settings, else of the model. Raises ModelError, SettingsError."""
    model, quality = settings.model, settings.quality
    used = in_use(Classifier(model.path, 1).card.thresholds, model.limits, model.segment_thresholds)
    values = {f"limits.{limit.kind.name}.threshold": limit.threshold for limit in used.kinds}
    values |= {f"limits.{limit.kind.name}.min_mm": limit.min_mm for limit in used.kinds}
    return values | {key: float(getattr(quality, key)) for key, (section, _, _) in FIELDS.items() if section == "quality"}
