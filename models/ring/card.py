"""RING.md, the card of a ring network, and the command that makes it again."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from models.ring.train import RingPlan


def ring_card(
    *,
    version: str,
    data_hash: str,
    command: str,
    lots: Sequence[Path],
    plan: RingPlan,
    weights: int,
    held_out: Mapping[str, int | float | None],
) -> str:
    """Return the text of RING.md."""
    card = {
        "version": version,
        "command": command,
        "data_hash": data_hash,
        "lots": [_facts(lot) for lot in lots],
        "plan": asdict(plan),
        "weights": weights,
        "held_out": dict(held_out),
    }
    return (
        "# Ring network\n\nWritten by the training run. The network has seen rendered pictures only. The\n"
        "figures are those of the station's `locate` on held-out pictures; errors are in px of 13 µm.\n\n"
        f"```json\n{json.dumps(card, indent=2)}\n```\n"
    )


def command(lots: Sequence[Path], *, seed: int, steps: int, leave_out: Sequence[str]) -> str:
    """Return the command line of a run, lots named by their folders alone."""
    left_out = f" --leave-out {' '.join(leave_out)}" if leave_out else ""
    names = " ".join(lot.name for lot in lots)
    return f"weldgate-models train-ring {names} --seed {seed} --steps {steps}{left_out}"


def _facts(lot: Path) -> dict[str, str | int | None]:
    """Return what is needed to draw a lot again."""
    labels = json.loads((lot / "labels.json").read_text(encoding="utf-8"))
    return {"folder": lot.name, "seed": labels.get("seed"), "pictures": len(labels["frames"])}
