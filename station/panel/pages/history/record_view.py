"""One record with everything that led to its verdict."""

from math import ceil
from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QGridLayout, QLabel, QVBoxLayout, QWidget

from station.analysis.worst_segment import worst_segment
from station.archive.reader import Row, read_record
from station.classify.thresholds import Thresholds
from station.defects import KINDS
from station.domain import SEGMENT_DEG, SEGMENTS, Finding, Inspection, Quality, Ring, Verdict
from station.errors import ImageError, LocateError
from station.journal.reviews import Marks
from station.panel.look.purposes import PURPOSE_WORDS
from station.panel.look.words import data, translate
from station.panel.widgets.card import Facts, Table, label, titled
from station.panel.widgets.weld.recorded import DELETED, NO_IMAGE, of_record
from station.panel.widgets.weld.strip_view import StripView
from station.panel.widgets.weld.weld_view import WeldView
from station.records import Record


class RecordView(QWidget):
    """Shows image, strip, findings and figures of a record, and which model judged it."""

    marked = Signal()
    """Emitted when a segment was marked or unmarked."""

    def __init__(self) -> None:
        super().__init__()
        self.record: Record | None = None
        self.strip_shown = False
        """True if the strip of the record is shown."""
        self.marks: Marks = {}
        """Segments in which the user says that a defect was missed, with its kind."""
        self.weld, self.strip = WeldView(), StripView(86)
        self.weld.setMinimumSize(260, 250)
        self.strip.touched.connect(self.mark)
        self.findings = Table(
            (
                translate("history", "finding"),
                translate("history", "from (°)"),
                translate("history", "to (°)"),
                translate("history", "length (mm)"),
                translate("history", "width (mm)"),
                translate("history", "area (mm²)"),
                translate("history", "score"),
            ),
            stretch=0,
        )
        self.findings.setMaximumHeight(150)
        self.findings.setMinimumHeight(76)
        self.facts = Facts(
            {
                "verdict": translate("history", "verdict"),
                "serial": translate("history", "serial"),
                "part": translate("history", "part · trigger"),
                "time": translate("history", "time"),
                "shown": translate("history", "reported to the PLC"),
                "quality": translate("history", "brightness · sharpness · saturated"),
                "ring": translate("history", "ring x · y · radius · residual (px)"),
                "novelty": translate("history", "distance to the training images"),
                "steps": translate("history", "times of the steps (ms)"),
                "limits": translate("history", "limits"),
                "model": translate("history", "model · recipe"),
                "hash": translate("history", "model hash · configuration"),
                "origin": translate("history", "origin · purpose"),
            }
        )
        self.problem: QLabel = label("", "problem", wrap=True)
        self.worst: QLabel = label("–", "quiet")
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.addWidget(self.weld, 0, 0)
        side = QVBoxLayout()
        side.addWidget(self.facts)
        side.addWidget(self.problem)
        side.addStretch(1)
        grid.addLayout(side, 0, 1)
        grid.addWidget(self.strip, 1, 0, 1, 2)
        grid.addWidget(self.worst, 2, 0, 1, 2)
        grid.addWidget(titled(translate("history", "findings"), self.findings), 3, 0, 1, 2)
        grid.setRowStretch(0, 1)
        grid.setColumnStretch(0, 1)

    def show_nothing(self, why: str = "") -> None:
        """Show no record; `why` is given if it cannot be read."""
        self.record, self.strip_shown, self.marks = None, False, {}
        self.problem.setText(why)
        self.worst.setText("–")
        self.weld.show_weld(
            None,
            translate("history", "The record cannot be read.") if why else translate("history", "no part"),
        )
        self.strip.show_strip(None, None)
        self.strip.show_marks({})
        self.findings.fill([])
        self.facts.set(**dict.fromkeys(self.facts.values, "–"))

    def clear_marks(self) -> None:
        """Remove all marks, as they are those of one user."""
        self.marks = {}
        self.strip.show_marks({})

    def mark(self, index: int) -> None:
        """Mark a touched segment of an OK part with each kind of defect in turn, then with none."""
        if self.record is None or self.record.verdict is not Verdict.OK:
            return
        current = self.marks.pop(index + 1, None)
        turns = [None, *(kind.reason for kind in KINDS), None]
        following = turns[turns.index(current) + 1]
        if following is not None:
            self.marks[index + 1] = following
        self.strip.show_marks({number: data(kind) for number, kind in self.marks.items()})
        self.marked.emit()

    def show_row(self, folder: Path, row: Row) -> None:
        """Read a record from disk and show it, with a message if something is missing or altered."""
        self.record, problem = read_record(folder, row)
        message = "" if problem is None else f"{row.record_file}: {problem}"
        if self.record is None:
            self.show_nothing(message)
            return
        self.problem.setText("\n".join(text for text in (message, self.record.inspection.detail) if text))
        self.worst.setText(_worst(self.record.inspection))
        self.marks = {}
        record, strip = self.record, self._show_image(folder, self.record)
        self.strip.show_strip(strip, record.inspection)
        self.strip.show_marks({})
        self.strip_shown = strip is not None
        self.findings.fill(
            [_finding_row(finding, record.inspection.nok) for finding in record.inspection.findings]
        )
        self._show_facts(record, row.shown_to_plc)

    def _show_image(self, folder: Path, record: Record) -> QImage | None:
        """Show the image of a record, or why there is none. Return its strip."""
        try:
            drawn, strip = of_record(folder, record)
        except (ImageError, LocateError) as error:
            is_known = str(error) in (NO_IMAGE, DELETED)
            unreadable = translate("history", "The image cannot be read.")
            self.weld.show_weld(None, data(str(error)) if is_known else unreadable)
            return None
        self.weld.show_weld(drawn)
        return strip

    def _show_facts(self, record: Record, reported: bool | None) -> None:
        inspection, provenance = record.inspection, record.provenance
        ring, quality, timing = inspection.ring, inspection.quality, inspection.timing
        reason = "" if inspection.reason is None else f": {data(inspection.reason)}"
        steps = (timing.grab_ms, timing.locate_ms, timing.unwrap_ms, timing.classify_ms)
        answers = {
            True: translate("history", "yes"),
            False: translate("history", "no"),
            None: translate("history", "unknown"),
        }
        self.facts.set(
            verdict=f"{data(record.verdict)}{reason}",
            serial=record.serial or "–",
            part=f"{record.inspection_id} · {record.trigger_id or '–'}",
            time=f"{record.grabbed_at.astimezone():%d.%m.%Y %H:%M:%S}",
            shown=answers[reported],
            quality="–" if quality is None else _quality(quality),
            novelty="–" if inspection.novelty is None else f"{inspection.novelty:.2f}",
            ring="–" if ring is None else _ring(ring),
            steps=" · ".join("–" if ms is None else f"{ms:.0f}" for ms in steps),
            limits="\n".join(_limits(provenance.thresholds)),
            model=f"{provenance.model_version} · {provenance.recipe}",
            hash=f"{provenance.model_hash[:12]} · {provenance.config_crc:04X}",
            origin=f"{data(record.origin)} · {data(PURPOSE_WORDS[record.purpose])}",
        )


def _finding_row(finding: Finding, nok: tuple[bool, ...]) -> tuple[str, ...]:
    """Return the texts of a finding; one in no rejected segment is tolerated."""
    is_tolerated = bool(nok) and not any(nok[index] for index in _segments(finding))
    tolerated = translate("history", "tolerated")
    return (
        data(finding.kind) + (f" ({tolerated})" if is_tolerated else ""),
        f"{finding.start_deg:.1f}",
        f"{finding.end_deg:.1f}",
        f"{finding.length_mm:.2f}",
        "–" if finding.width_mm is None else f"{finding.width_mm:.2f}",
        "–" if finding.area_mm2 is None else f"{finding.area_mm2:.2f}",
        f"{finding.score:.3f}",
    )


def _quality(quality: Quality) -> str:
    return f"{quality.mean_dn:.0f} · {quality.sharpness:.3f} · {quality.saturated_share:.1%}"


def _worst(inspection: Inspection) -> str:
    """Return the values of the worst segment as one line."""
    worst = worst_segment(inspection)
    if worst is None:
        return "–"
    visible = "–" if worst.visible is None else f"{worst.visible:.0%}"
    return translate(
        "history",
        "worst segment: brightness {mean:.0f} · contrast {contrast:.2f} · sharpness {sharpness:.3f} · "
        "fine structure {structure:.2f} · saturated {saturated:.1%} · weld {weld:.0%} · visible {visible}",
    ).format(
        mean=worst.mean_dn,
        contrast=worst.contrast,
        sharpness=worst.sharpness,
        structure=worst.fine_structure,
        saturated=worst.saturated_fraction,
        weld=worst.weld,
        visible=visible,
    )


def _segments(finding: Finding) -> list[int]:
    """Return the indices of the segments in which a finding lies."""
    first, last = int(finding.start_deg // SEGMENT_DEG), ceil(finding.end_deg / SEGMENT_DEG) - 1
    return [index % SEGMENTS for index in range(first, max(first, last) + 1)]


def _ring(ring: Ring) -> str:
    return f"{ring.center_x_px:.1f} · {ring.center_y_px:.1f} · {ring.radius_px:.1f} · {ring.residual_px:.2f}"


def _limits(thresholds: Thresholds) -> list[str]:
    lines = [f"{data(limit.kind.reason)} {limit.threshold:.2f}" for limit in thresholds.kinds]
    if thresholds.segments:
        lines.append(", ".join(f"{number}: {limit:g}" for number, limit in thresholds.segments))
    if any(limit.min_mm for limit in thresholds.kinds):
        lines.append(" · ".join(f"≥ {limit.min_mm:g} mm" for limit in thresholds.kinds))
    return lines
