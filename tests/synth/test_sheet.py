"""Contact sheets and figures: files that open, of the size that was meant."""

from pathlib import Path

import cv2
import pytest

from synth.__main__ import main
from synth.output.plan import quotas


@pytest.mark.render
def test_a_sheet_of_a_dataset_and_of_the_switches(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--flat", "--base", "paper", "--count", "26", "--workers", "1"]
    assert main(["dataset", "--out", str(tmp_path / "set"), *options]) == 0
    assert main(["sheet", str(tmp_path / "set"), "--out", str(tmp_path / "set.png")]) == 0
    image = cv2.imread(str(tmp_path / "set.png"), cv2.IMREAD_UNCHANGED)
    blocks = quotas(26).values()
    assert image.shape == (sum(-(-crops // 12) for crops in blocks) * 134 + len(blocks) * 26, 12 * 134 + 6)
    assert main(["sheet", "--out", str(tmp_path / "switches.png")]) == 0
    image = cv2.imread(str(tmp_path / "switches.png"), cv2.IMREAD_UNCHANGED)
    assert image.shape[0] == 9 * (134 + 26)


def test_a_measurement_is_shown(
    tmp_path: Path, planted_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert (
        main(["measurement", str(planted_file), "--step-um", "5", "--figure", str(tmp_path / "figure.png")])
        == 0
    )
    said = capsys.readouterr().out
    assert "dominant pitch 0.15" in said
    assert "4.50 x 3.00 mm" in said
    assert cv2.imread(str(tmp_path / "figure.png")).shape[0] > 800
    assert (
        main(
            [
                "measurement",
                str(planted_file),
                "--step-um",
                "5",
                "--figure",
                str(tmp_path / "no" / "figure.png"),
            ]
        )
        == 2
    )
