"""The tab Camera: a live image with figures for focus, brightness and ring, histogram, exposure and gain."""

from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLineEdit, QPushButton, QVBoxLayout, QWidget

from station.channel.events import SetupImageEvent
from station.channel.requests import MIN_REASON, Changed, HoldService
from station.domain import Ring
from station.journal.users import Level
from station.panel.look.words import data, translate
from station.panel.pages.page import Page
from station.panel.session.session import Session
from station.panel.widgets.card import Facts, label, titled
from station.panel.widgets.charts import Chart
from station.panel.widgets.field import NumberField
from station.panel.widgets.weld.previews import drawn
from station.panel.widgets.weld.weld_view import WeldView
from station.settings.model import for_recipe


class CameraPage(Page):
    """Shows setup images, which are taken in service mode: READY is 0, nothing is recorded."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self._best = 0.0
        self._ring: Ring | None = None
        self._saving = False
        """True while the engine has not answered to a change that was made here."""
        self.live = QPushButton(translate("camera", "Live image"))
        self.live.setCheckable(True)
        self.live.clicked.connect(self._toggle)
        self.exposure, self.gain = NumberField(1.0, 1_000_000.0, "µs"), NumberField(0.0, 48.0, "dB")
        self.reason, self.save = QLineEdit(), QPushButton(translate("camera", "Save"))
        self.reason.setPlaceholderText(translate("camera", "reason (required)"))
        self.problem, self.message = label("", "problem", wrap=True), label("", "quiet", wrap=True)
        self.weld, self.histogram = WeldView(), Chart(translate("camera", "grey levels"))
        self.facts = Facts(
            {
                "focus": translate("camera", "sharpness · best so far"),
                "brightness": translate("camera", "mean brightness (0 to 255)"),
                "saturated": translate("camera", "saturated fraction"),
                "radius": translate("camera", "ring radius · expected (px)"),
                "residual": translate("camera", "ring residual (px) · support"),
            },
            big=("focus",),
        )
        box = QWidget()
        form = QGridLayout(box)
        form.setVerticalSpacing(2)
        for place, (name, field) in enumerate(
            ((translate("camera", "exposure"), self.exposure), (translate("camera", "gain"), self.gain))
        ):
            form.addWidget(label(name), place, 0)
            form.addWidget(field, place, 1)
        form.addWidget(self.reason, 2, 0, 1, 2)
        form.addWidget(self.save, 3, 0, 1, 2)
        form.addWidget(self.message, 4, 0, 1, 2)
        side = QWidget()
        side.setFixedWidth(420)
        column = QVBoxLayout(side)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.live)
        column.addWidget(self.facts)
        column.addWidget(self.histogram, 1)
        column.addWidget(titled(translate("camera", "settings"), box))
        column.addWidget(self.problem)
        row = QHBoxLayout(self)
        row.addWidget(self.weld, 1)
        row.addWidget(side)
        for field in (self.exposure, self.gain):
            field.changed.connect(self._refresh_buttons)
        self.reason.textChanged.connect(self._refresh_buttons)
        self.save.clicked.connect(self._save)
        session.received.setup_image_came.connect(self._on_setup_image)
        session.received.preview_came.connect(self._on_preview)
        session.account.changed.connect(self._on_user)
        session.received.settings_changed.connect(self._fill)
        session.change.used.connect(self._on_used)
        session.change.refused.connect(self._on_refused)
        session.service.changed.connect(self._refresh_buttons)
        session.service.refused.connect(self._on_service_refused)
        self._fill()

    def _fill(self) -> None:
        used = self._session.received.settings.camera.adjustable
        if used is not None:
            for field, value in zip((self.exposure, self.gain), used, strict=True):
                field.set(value)
        self._refresh_buttons()

    def _on_user(self) -> None:
        self._saving = False
        self.reason.clear()
        self.message.setText("")
        self._refresh_buttons()

    def _on_used(self) -> None:
        self._fill()
        if self._saving:
            self._saving = False
            self.reason.clear()
            self.message.setText(translate("camera", "Saved and in use."))

    def _on_refused(self, why: str) -> None:
        self._refresh_buttons()
        if self._saving:
            self._saving = False
            self._fill()
            self.message.setText("")
            nothing = translate("camera", "Nothing was changed:")
            self.problem.setText(f"{nothing} {data(why)}")

    def _refresh_buttons(self) -> None:
        session, used = self._session, self._session.received.settings.camera.adjustable
        is_live = session.service.held is not None and session.service.held.look
        self.live.setChecked(is_live)
        self.live.setEnabled(session.account.may(Level.SETTER))
        for field in (self.exposure, self.gain):
            field.setEnabled(used is not None and session.account.may(Level.SETTER))
        changed = used is not None and (self.exposure.value, self.gain.value) != used
        valid = changed and self.exposure.value is not None and self.gain.value is not None
        allowed = session.account.may(Level.SETTER) and not session.change.waiting
        self.save.setEnabled(valid and allowed and len(self.reason.text().strip()) >= MIN_REASON)
        self.problem.setText(
            "" if session.account.may(Level.SETTER) else translate("camera", "Log in as setter first.")
        )
        if is_live and self.exposure.value is not None and self.gain.value is not None:
            session.service.adjust(self.exposure.value, self.gain.value)

    def _toggle(self) -> None:
        service = self._session.service
        if service.held is not None and service.held.look:
            service.end()
        elif self._session.account.user is not None:
            self._best = 0.0
            self._refresh_buttons()
            self.live.setEnabled(False)  # until the engine has answered
            service.hold(HoldService(look=True, exposure_us=self.exposure.value, gain_db=self.gain.value))

    def _on_service_refused(self, why: str) -> None:
        self._refresh_buttons()
        self.problem.setText(data(why))

    def _on_setup_image(self, event: SetupImageEvent) -> None:
        self._ring = event.ring
        self._best = max(self._best, event.sharpness)
        status = self._session.received.status
        weld = for_recipe(self._session.received.settings, 1 if status is None else status.recipe).weld
        expected = weld.radius_mm * 1000 / weld.um_per_px
        ring = event.ring
        self.facts.set(
            focus=f"{event.sharpness:.4f} · {self._best:.4f}",
            brightness=f"{event.mean_dn:.0f}",
            saturated=f"{event.saturated_share:.1%}",
            radius="–" if ring is None else f"{ring.radius_px:.1f} · {expected:.1f}",
            residual="–" if ring is None else f"{ring.residual_px:.2f} · {ring.support:.0%}",
        )
        self.histogram.show_counts(event.histogram, 0, 4)
        if event.problem:
            self.problem.setText(data(event.problem))
        elif self._session.account.may(Level.SETTER):
            self.problem.setText("")

    def _on_preview(self) -> None:
        preview = self._session.received.setup_preview
        if preview is not None and self._session.service.held is not None:
            self.weld.show_weld(drawn(preview, self._ring))

    def _save(self) -> None:
        used = self._session.received.settings.camera.adjustable
        if used is None or self.exposure.value is None or self.gain.value is None:
            return
        values = zip(("exposure_us", "gain_db"), used, (self.exposure.value, self.gain.value), strict=True)
        changes = [
            Changed(("camera", key), after, before) for key, before, after in values if before != after
        ]
        self._saving = True
        self.message.setText(translate("camera", "Waiting for the engine..."))
        self._session.change.make(changes, self.reason.text())
        self._refresh_buttons()

    def close_page(self) -> None:
        """Do nothing: the session ends service mode."""
