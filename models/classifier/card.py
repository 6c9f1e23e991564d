"""The model card: the facts of a training run, as run.json for programs and as CARD.md for people."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path

from pydantic import ConfigDict, TypeAdapter, ValidationError

from models.classifier.plan import Plan
from models.errors import LearningError
from station.defects import kind_named


@dataclass(frozen=True, slots=True, kw_only=True)
class Decisions:
    """Figures of the decisions on held-out crops; positive means NOK."""

    tp: int
    fp: int
    fn: int
    tn: int
    precision: float
    recall: float
    f2: float


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldOut(Decisions):
    """Figures of a classifier on held-out crops."""

    calibration_error: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RunCard:
    """Facts of a training run of the classifier. The names of the fields are those in run.json."""

    __pydantic_config__ = ConfigDict(extra="forbid")

    version: str
    provenance: str
    """Sentence on where the images come from."""
    data_hash: str
    """SHA-256 of the images."""
    training_crops: int
    training_kinds: tuple[int, ...]
    """Number of OK crops among them, and of crops of each kind of defect, in the order of `CLASSES`."""
    held_out_crops: int
    weights: int
    thresholds: dict[str, float]
    """Threshold of each kind of defect, by name."""
    held_out: HeldOut
    novelty_limit: float
    seconds: float
    """Training time."""
    plan: Plan


def write_card(out: Path, card: RunCard) -> None:
    """Write run.json with all facts, and CARD.md for people."""
    (out / "run.json").write_text(card_json(card))
    (out / "CARD.md").write_text(card_text(card))


def card_json(card: RunCard) -> str:
    """Return the text of run.json."""
    return json.dumps(asdict(card), indent=1) + "\n"


def read_card(path: Path) -> RunCard:
    """Read a run.json. Raises LearningError."""
    try:
        return TypeAdapter(RunCard).validate_json(path.read_bytes(), strict=True)
    except OSError as error:
        raise LearningError(
            f"{path}: cannot be read ({error.strerror}). Name the run.json of a training run"
        ) from None
    except ValidationError as error:
        first = error.errors()[0]
        problem = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
        raise LearningError(f"{path}: not the card of a training run ({problem}). Restore the file") from None


def card_text(card: RunCard) -> str:
    """Return the text of CARD.md."""
    held_out = card.held_out
    kinds = [kind_named(name) for name in card.thresholds]
    counts = ", ".join(map(str, card.training_kinds))
    limits = ", ".join(f"{kind.reason} {card.thresholds[kind.name]}" for kind in kinds)
    channels = ", ".join(kind.reason for kind in kinds if kind.is_mapped)
    figures = f"{held_out.precision:.4f}, {held_out.recall:.4f}, {held_out.f2:.4f}"
    nok, ok = held_out.fn + held_out.tp, held_out.fp + held_out.tn
    rows = [
        ("version", card.version),
        (
            "training crops",
            f"{card.training_crops}; {', '.join(['OK', *(k.reason for k in kinds)])}: {counts}",
        ),
        ("held-out crops", f"{card.held_out_crops}, of other parts of the same data"),
        ("data SHA-256", card.data_hash),
        ("weights", card.weights),
        ("thresholds", f"{limits}: best F2 on held-out crops"),
        ("precision, recall, F2", f"{figures} for NOK on the held-out crops, judged through the file"),
        ("escapes, false rejects", f"{held_out.fn}, {held_out.fp} of {nok} NOK and {ok} OK crops"),
        ("calibration error", f"{held_out.calibration_error:.4f}"),
        ("novelty limit", card.novelty_limit),
        ("training time", f"{card.seconds:.0f} s"),
    ]
    table = "\n".join(f"| {name} | {value} |" for name, value in rows)
    plan = json.dumps({"plan": asdict(card.plan)}, indent=1)
    return (
        "# Model card\n\nWritten by the training run.\n\n"
        f"| | |\n|---|---|\n{table}\n\n"
        f"{card.provenance} The figures do not predict those on a real line: measure there before\n"
        "release (`weldgate-models evaluate`, `weldgate-models first-day`).\n\n"
        "Input: `crops` uint8 (K, 1, 128, 128), crops of the unwrapped weld, row 0 outermost.\n\n"
        "Outputs:\n\n"
        f"- `probabilities` (K, {1 + len(kinds)}): {', '.join(['ok', *card.thresholds])}\n"
        "- `maps`: the fraction of each cell of 4 x 4 px that a defect covers, a channel for each of\n"
        f"  {channels or 'no kind'}\n"
        "- `looks` (K, 192): appearance features of each crop, whitened on the training crops (zero mean,\n"
        "  unit covariance)\n\n"
        f"```json\n{plan}\n```\n"
    )
