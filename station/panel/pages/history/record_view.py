"""One record with everything that led to its verdict."""

from math import ceil
from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QVBoxLayout, QWidget

from station.archive.reader import Row, read_record
from station.classify.thresholds import Thresholds
from station.defects import KINDS
from station.domain import SEGMENT_DEG, SEGMENTS, Finding, Ring, Verdict
from station.errors import ImageError, LocateError
from station.journal.reviews import Marks
from station.panel.look.words import data, translate
from station.panel.widgets.card import Facts, Table, label, titled
from station.panel.widgets.weld.kept import of_record
from station.panel.widgets.weld.pictures import nok_scores
from station.panel.widgets.weld.strip_view import StripView
from station.panel.widgets.weld.weld_view import WeldView
from station.records import Record


class RecordView(QWidget):
    """Picture, strip, findings, figures, who judged."""

    marked = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.record: Record | None = None
        self.strip_shown = False
        """Whether its picture is there."""
        self.marks: Marks = {}
        """Where somebody says that a defect was missed."""
        self.weld, self.strip = WeldView(), StripView(96)
        self.weld.setMinimumSize(260, 250)
        self.strip.touched.connect(self.mark)
        self.findings = Table(
            (
                translate("history", "finding"),
                translate("history", "from °"),
                translate("history", "to °"),
                translate("history", "length mm"),
                translate("history", "width mm"),
                translate("history", "area mm²"),
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
                "shown": translate("history", "seen by the PLC"),
                "quality": translate("history", "brightness · sharpness · saturated"),
                "ring": translate("history", "ring x · y · r · residual px"),
                "novelty": translate("history", "distance to the training images"),
                "steps": translate("history", "steps ms"),
                "limits": translate("history", "limits"),
                "model": translate("history", "model · recipe"),
                "hash": translate("history", "model's hash · configuration"),
                "origin": translate("history", "origin · purpose"),
            }
        )
        self.problem: QLabel = label("", "problem", wrap=True)
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.addWidget(self.weld, 0, 0)
        side = QVBoxLayout()
        side.addWidget(self.facts)
        side.addWidget(self.problem)
        side.addStretch(1)
        grid.addLayout(side, 0, 1)
        grid.addWidget(self.strip, 1, 0, 1, 2)
        grid.addWidget(titled(translate("history", "findings"), self.findings), 2, 0, 1, 2)
        grid.setRowStretch(0, 1)
        grid.setColumnStretch(0, 1)

    def show_nothing(self, why: str = "") -> None:
        """No record, or one that cannot be read."""
        self.record, self.strip_shown, self.marks = None, False, {}
        self.problem.setText(why)
        self.weld.show_weld(
            None,
            translate("history", "the record cannot be read") if why else translate("history", "no part"),
        )
        self.strip.show_strip(None, (), ())
        self.strip.show_marks({})
        self.findings.fill([])
        self.facts.set(**dict.fromkeys(self.facts.values, "–"))

    def clear_marks(self) -> None:
        """They are one person's."""
        self.marks = {}
        self.strip.show_marks({})

    def mark(self, index: int) -> None:
        """Mark a touched cell of an OK part: each kind of defect in turn, then none."""
        if self.record is None or self.record.verdict is not Verdict.OK:
            return
        now = self.marks.pop(index + 1, None)
        turns = [None, *(kind.reason for kind in KINDS), None]
        following = turns[turns.index(now) + 1]
        if following is not None:
            self.marks[index + 1] = following
        self.strip.show_marks({number: data(kind) for number, kind in self.marks.items()})
        self.marked.emit()

    def show_row(self, folder: Path, row: Row) -> None:
        """Read it from disk; what is missing or wrong is said."""
        self.record, problem = read_record(folder, row)
        said = "" if problem is None else f"{row.record_file}: {problem}"
        if self.record is None:
            self.show_nothing(said)
            return
        self.problem.setText(said)
        record, inspection = self.record, self.record.inspection
        nok = inspection.nok
        self.marks = {}
        try:
            drawn, strip = of_record(folder, record)
            self.weld.show_weld(drawn)
        except (ImageError, LocateError) as error:
            strip = None
            self.weld.show_weld(
                None,
                data(str(error))
                if len(str(error)) < 60
                else translate("history", "its picture cannot be read"),
            )
        self.strip.show_strip(strip, nok_scores(record), nok)
        self.strip.show_marks({})
        self.strip_shown = strip is not None
        tolerated = translate("history", "tolerated")
        self.findings.fill(
            [
                (
                    data(f.kind)
                    + (f" ({tolerated})" if nok and not any(nok[s] for s in _segments(f)) else ""),
                    f"{f.start_deg:.1f}",
                    f"{f.end_deg:.1f}",
                    f"{f.length_mm:.2f}",
                    "–" if f.width_mm is None else f"{f.width_mm:.2f}",
                    "–" if f.area_mm2 is None else f"{f.area_mm2:.2f}",
                    f"{f.score:.3f}",
                )
                for f in inspection.findings
            ]
        )
        reason = "" if inspection.reason is None else f": {data(inspection.reason)}"
        ring, q, t, p = inspection.ring, inspection.quality, inspection.timing, record.provenance
        steps = (t.grab_ms, t.locate_ms, t.unwrap_ms, t.classify_ms)
        shown = {
            True: translate("history", "yes"),
            False: translate("history", "no"),
            None: translate("history", "unknown"),
        }
        self.facts.set(
            verdict=f"{data(record.verdict)}{reason}",
            serial=record.serial or "–",
            part=f"{record.inspection_id} · {record.trigger_id or '–'}",
            time=f"{record.grabbed_at.astimezone():%d.%m.%Y %H:%M:%S}",
            shown=shown[row.shown_to_plc],
            quality="–" if q is None else f"{q.mean_dn:.0f} · {q.sharpness:.3f} · {q.saturated_share:.1%}",
            novelty="–" if inspection.novelty is None else f"{inspection.novelty:.2f}",
            ring="–" if ring is None else _ring(ring),
            steps=" · ".join("–" if ms is None else f"{ms:.0f}" for ms in steps),
            limits="\n".join(_limits(p.thresholds)),
            model=f"{p.model_version} · {p.recipe}",
            hash=f"{p.model_hash[:12]} · {p.config_crc:04X}",
            origin=f"{data(record.origin)} · {data(record.purpose)}",
        )


def _segments(finding: Finding) -> list[int]:
    """Indices of the segments that it lies in."""
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
