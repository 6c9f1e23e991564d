"""An evaluation as lines, JSON and a self-contained HTML page."""

import base64
import json
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from models.data.crops import OK
from models.evaluation.evaluate import Evaluation
from models.evaluation.measures import ESCAPE_COST, calibration_error, count
from station.analysis.report.template import render
from station.analysis.truth import interval
from station.classify.onnx import CLASSES
from station.files.durable import write_whole

SIZES_MM = (0.0, 0.15, 0.3, 0.6, 1.2, 1e9)
"""Bounds of the lengths by which found defects are counted."""
TEMPLATE = Path(__file__).with_name("report.html.j2")


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationPage:
    """Contents of report.html.j2; images are PNG."""

    title: str
    facts: tuple[tuple[str, str], ...]
    lines: tuple[str, ...]
    curves_base64: str | None
    """None if all truths are the same."""
    confusion_head: tuple[str, ...]
    confusion: tuple[tuple[str, ...], ...]
    defects: tuple[tuple[str, str, str], ...]
    """Kind, length and how many were found."""
    worst_base64: str | None


def summary(found: Evaluation) -> dict[str, Any]:
    """Return all figures, ready for JSON."""
    truth = found.labels != OK
    counts = count(found.nok, truth)
    answer: dict[str, Any] = {
        "segments": {
            **asdict(counts),
            "precision": counts.precision,
            "recall": counts.recall,
            "f2": counts.f2,
            "calibration_error": calibration_error(
                1 - found.scores[:, OK], truth, np.where(truth, ESCAPE_COST, 1.0)
            ),
            "confusion": _confusion(found),
        }
    }
    if found.parts:
        answer["parts"] = _parts(found)
        answer["defects"] = _by_size(found)
    return answer


def _confusion(found: Evaluation) -> dict[str, dict[str, int]]:
    """Count the crops by what they show (outer) and what was decided (inner)."""
    return {
        name: {
            other: int(((found.labels == i) & (found.decided == j)).sum()) for j, other in enumerate(CLASSES)
        }
        for i, name in enumerate(CLASSES)
    }


def _parts(found: Evaluation) -> dict[str, Any]:
    escapes, rejects = found.named("NOK", "OK"), found.named("OK", "NOK")
    errors = [f"{p.name} ({p.reason})" for p in found.parts if p.verdict == "ERROR"]
    bad, good = (sum(p.truth == t for p in found.parts) for t in ("NOK", "OK"))
    rings = [
        (p.center_error_px, p.radius_error_px)
        for p in found.parts
        if p.center_error_px is not None and p.radius_error_px is not None
    ]
    answer = {
        "count": len(found.parts),
        "right": sum(p.truth == p.verdict for p in found.parts),
        "nok": bad,
        "ok": good,
        "escapes": escapes,
        "escape_rate_95": interval(len(escapes), bad),
        "false_rejects": rejects,
        "false_reject_rate_95": interval(len(rejects), good),
        "not_judged": errors,
        "nok_segments_not_judged": found.unjudged,
        "reported_as_novel": sum(p.novel for p in found.parts),
    }
    if rings:
        center, radius = zip(*rings, strict=True)
        answer |= {
            "center_error_px": [median(center), max(center)],
            "radius_error_px": [median(radius), max(radius)],
        }
    return answer


def _by_size(found: Evaluation) -> list[dict[str, Any]]:
    """Count the defects found, by kind and length."""
    rows = []
    for kind in CLASSES[1:]:
        for low, high in pairwise(SIZES_MM):
            hits = [
                d.found
                for p in found.parts
                for d in p.defects
                if d.kind == kind and d.length_mm is not None and low <= d.length_mm < high
            ]
            if hits:
                rows.append(
                    {
                        "kind": kind,
                        "from_mm": low,
                        "to_mm": None if high > 1e8 else high,
                        "found": sum(hits),
                        "of": len(hits),
                    }
                )
    return rows


def lines(found: Evaluation) -> list[str]:
    """Return the figures as text."""
    figures = summary(found)
    segments, parts = figures["segments"], figures.get("parts")
    precision, recall, f2 = (f"{segments[name]:.3f}" for name in ("precision", "recall", "f2"))
    wrong = f"{segments['fn']} missed, {segments['fp']} false"
    on_segments = [
        f"segments: precision {precision}, recall {recall}, F2 {f2} ({wrong})",
        f"calibration error {segments['calibration_error']:.3f}",
    ]
    if parts is None:
        return on_segments
    return [*_verdicts(parts), *on_segments, *_named(parts)]


def _verdicts(parts: dict[str, Any]) -> list[str]:
    escapes, rejects = len(parts["escapes"]), len(parts["false_rejects"])
    wrong = f"{escapes} escapes, {rejects} false rejects, {len(parts['not_judged'])} not judged"
    of_escapes, of_rejects = _percent(parts["escape_rate_95"]), _percent(parts["false_reject_rate_95"])
    answer = [
        f"{parts['count']} parts: {parts['right']} right, {wrong}",
        f"95 % intervals: escapes {of_escapes}, false rejects {of_rejects}",
    ]
    if "center_error_px" in parts:
        (center, radius) = parts["center_error_px"], parts["radius_error_px"]
        errors = f"centre {center[0]:.2f}, {center[1]:.2f} px; radius {radius[0]:.2f}, {radius[1]:.2f} px"
        answer.append(f"ring, median and maximum error: {errors}")
    return answer


def _named(parts: dict[str, Any]) -> list[str]:
    answer = []
    if parts["reported_as_novel"]:
        answer.append(f"{parts['reported_as_novel']} parts are unlike the training images")
    titles = (("escaped", "escapes"), ("falsely rejected", "false_rejects"), ("not judged", "not_judged"))
    answer += [f"{title}: {', '.join(parts[key])}" for title, key in titles if parts[key]]
    return answer


def _percent(bounds: tuple[float, float]) -> str:
    return f"{bounds[0]:.1%} to {bounds[1]:.1%}"


def write_report(found: Evaluation, folder: Path, title: str, facts: dict[str, str]) -> None:
    """Write report.html and evaluation.json into `folder`; `facts` name the data and the network."""
    folder.mkdir(parents=True, exist_ok=True)
    figures = summary(found)
    write_whole(folder / "evaluation.json", (json.dumps({**facts, **figures}, indent=1) + "\n").encode())
    write_whole(folder / "report.html", render(TEMPLATE, _page(found, figures, title, facts)).encode())


def _page(found: Evaluation, figures: dict[str, Any], title: str, facts: dict[str, str]) -> EvaluationPage:
    from models.evaluation.figures import curves, sheet

    nok, truth = 1 - found.scores[:, OK], found.labels != OK
    confusion, defects = figures["segments"]["confusion"], figures.get("defects", ())
    titles = [f"{w.name}\n{CLASSES[w.label]}: probability of NOK {w.nok:.2f}" for w in found.worst]
    return EvaluationPage(
        title=title,
        facts=tuple(facts.items()),
        lines=tuple(lines(found)),
        curves_base64=_base64(curves(nok, truth, ESCAPE_COST)) if truth.any() and not truth.all() else None,
        confusion_head=("", *CLASSES),
        confusion=tuple((name, *map(str, row.values())) for name, row in confusion.items()),
        defects=tuple((d["kind"], _span(d), f"{d['found']} of {d['of']}") for d in defects),
        worst_base64=_base64(sheet([w.image for w in found.worst], titles)) if found.worst else None,
    )


def _span(row: dict[str, Any]) -> str:
    return (
        f"from {row['from_mm']:g} mm"
        if row["to_mm"] is None
        else f"{row['from_mm']:g} to {row['to_mm']:g} mm"
    )


def _base64(content: bytes) -> str:
    return base64.b64encode(content).decode()
