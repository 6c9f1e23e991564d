"""The plan of a training run of the classifier."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from models.data.crops import DEFECTS, OK
from models.errors import LearningError
from station.classify.onnx import CLASSES
from station.defects import KINDS


def batch_fractions() -> tuple[float, ...]:
    """Return the fractions of a batch: half OK, and half by how frequent each kind of defect is on a line."""
    fractions = [kind.line_fraction for kind in KINDS]
    return 0.5, *(fraction / (2 * sum(fractions)) for fraction in fractions)


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """How to train. The names of the fields are those in run.json."""

    steps: int = 5000
    batch: int = 64
    learning_rate: float = 0.003
    weight_decay: float = 0.02
    shares: tuple[float, ...] = batch_fractions()
    """Fractions of OK and of each kind of defect in a batch, in the order of `CLASSES`."""
    map_weight: float = 4.0
    """Weight of the defect map's loss against that of the classes."""
    smoothing: float = 0.02
    average: float = 0.998
    """Fraction of the old weights in the moving average that is the result."""
    hardness: float = 0.25
    """How much more often a crop is drawn the larger its last loss was; 0: all alike."""
    unseen_loss: float | None = 1.4
    """Mean loss from which a rendered defect is left out after half of the steps; None: none is.

    A defect lost in the dark or in blur teaches only false alarms; at 1.4 it is taken for OK with more than
    75 %. None suits images that a person has labelled: what was labelled can be seen.
    """
    seed: int = 0

    def limited_to(self, kinds: Sequence[int]) -> "Plan":
        """Return the plan with batches of OK crops and of `kinds` (labels) only. Raises LearningError."""
        ok, total = self.shares[OK], sum(self.shares[label] for label in kinds)
        if not total > 0:
            names = ", ".join(CLASSES[label] for label in kinds)
            raise LearningError(
                f"no crops of {names} would be drawn. Set line_fraction in station/defects.py"
            )
        own = (self.shares[label] if label in kinds else 0.0 for label in DEFECTS)
        return replace(self, shares=(ok, *((1 - ok) * one / total for one in own)))
