"""Self-test: judges a stored frame while no part is present, to prove that the inspection works."""

from pathlib import Path

from station.domain import Inspection
from station.errors import ModelError
from station.files.image import read_image
from station.inspection.inspector import Inspector


class SelfTest:
    """A stored frame with its inspection at the start, which must not change."""

    def __init__(self, inspector: Inspector, path: Path, verdict: str | None = None) -> None:
        """Read and judge the frame; None: any verdict will do, if all segments are judged.

        Raises ImageError, ModelError if it does not get this verdict.
        """
        self._inspector, self._image = inspector, read_image(path)
        self._expected = inspector.inspect(self._image)
        if verdict is None:
            if not self._expected.scores:
                raise ModelError(f"{path}: cannot be judged with these settings ({self._expected.reason})")
            return
        if self._expected.verdict != verdict:
            found = (
                f"{self._expected.verdict}, {self._expected.reason}"
                if self._expected.reason
                else str(self._expected.verdict)
            )
            raise ModelError(
                f"{path}: the self-test gives {found}, not {verdict}; check networks, limits and this PC"
            )

    def passes(self) -> bool:
        """Judge the frame again and return whether the result is the same, bit for bit."""
        return _found(self._inspector.inspect(self._image)) == _found(self._expected)


def _found(inspection: Inspection) -> tuple[object, ...]:
    seen = inspection.segment_quality
    return inspection.verdict, inspection.ring, inspection.scores, inspection.findings, seen
