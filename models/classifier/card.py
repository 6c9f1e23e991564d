"""The model card: written by the run, from its figures."""

import json
from pathlib import Path
from typing import Any

from station.defects import kind_named


def write_card(out: Path, card: dict[str, Any]) -> None:
    """`run.json` with all figures, and CARD.md for people."""
    (out / "run.json").write_text(json.dumps(card, indent=1) + "\n")
    (out / "CARD.md").write_text(card_text(card))


def card_text(card: dict[str, Any]) -> str:
    """CARD.md of a run's figures."""
    held, thresholds = card["held_out"], card["thresholds"]
    kinds = ", ".join(kind_named(name).reason for name in thresholds)
    limits = ", ".join(f"{kind_named(name).reason} {value}" for name, value in thresholds.items())
    channels = " or ".join(
        f"a {kind_named(name).reason}" for name in thresholds if kind_named(name).is_mapped
    )
    rows = [
        ("version", card["version"]),
        (
            "trained on",
            f"{card['training_crops']} crops; OK, {kinds}: {', '.join(map(str, card['training_kinds']))}",
        ),
        ("held out", f"{card['held_out_crops']} crops of other parts of the same data"),
        ("data SHA-256", card["data_hash"]),
        ("weights", card["weights"]),
        ("thresholds", f"{limits}: best F2 on the crops held out"),
        (
            "precision, recall, F2",
            f"{held['precision']:.4f}, {held['recall']:.4f}, {held['f2']:.4f} of NOK on them, through the file",
        ),
        (
            "escapes, false rejects",
            f"{held['fn']}, {held['fp']} of {held['fn'] + held['tp']} NOK and {held['fp'] + held['tn']} OK crops",
        ),
        ("calibration error", f"{held['calibration_error']:.4f}"),
        ("novelty limit", card["novelty_limit"]),
        ("training time", f"{card['seconds']:.0f} s"),
    ]
    if "int8" in card:
        rows.append(("int8", card["int8"]))
    table = "\n".join(f"| {name} | {value} |" for name, value in rows)
    return (
        "# Model card\n\nWritten by the training run.\n\n"
        f"| | |\n|---|---|\n{table}\n\n"
        f"{card['provenance']} The figures say nothing of a real line: measure there before release\n"
        "(`weldgate-models evaluate`, `weldgate-models first-day`).\n\n"
        "Input `crops` uint8 (K, 1, 128, 128): crops of the unwrapped weld, row 0 outermost. Outputs: `probabilities`\n"
        f"(K, {1 + len(thresholds)}) of {', '.join(['ok', *thresholds])}; `maps`, the share of each cell of 4 x 4 px that\n"
        f"{channels} covers, a channel each; `looks` (K, 192),\n"
        "statistics of what each crop looks like, of mean 0 and covariance 1 over the training crops.\n\n"
        f"```json\n{json.dumps({'plan': card['plan']}, indent=1)}\n```\n"
    )
