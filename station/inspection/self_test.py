"""A stored frame judged again and again: the proof that the inspection still works, made while no part is there."""

from pathlib import Path

from station.domain import Inspection
from station.errors import ModelError
from station.files.image import read_image
from station.inspection.inspector import Inspector


class SelfTest:
    """The frame, and what was found in it when the station started."""

    def __init__(self, inspector: Inspector, path: Path, verdict: str) -> None:
        """Raises ImageError; ModelError if the frame is not judged as it must be."""
        self._inspector, self._image = inspector, read_image(path)
        self._expected = inspector.inspect(self._image)
        if self._expected.verdict != verdict:
            found = (
                f"{self._expected.verdict}, {self._expected.reason}"
                if self._expected.reason
                else str(self._expected.verdict)
            )
            raise ModelError(
                f"{path}: the self-test frame is judged {found}, must be {verdict}; check networks, limits and this PC"
            )

    def passes(self) -> bool:
        """Whether the same is found again, to the bit."""
        return _found(self._inspector.inspect(self._image)) == _found(self._expected)


def _found(inspection: Inspection) -> tuple[object, ...]:
    return inspection.verdict, inspection.ring, inspection.scores, inspection.findings
