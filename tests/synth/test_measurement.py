"""Reading a surface measurement: real files, turned, lossy and broken ones."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from synth.__main__ import main
from synth.errors import SynthError
from synth.measured.artificial import HEIGHT_STEP_UM, NOTE, write_x3p
from synth.measured.measurement import SHIPPED, Measurement, read_measurement

Array = NDArray[np.float64]


def test_the_shipped_map_is_as_the_paper_says(measurement: Measurement) -> None:
    assert measurement.height_um.shape == (2000, 2000)
    assert measurement.step_um == pytest.approx(3.0)
    assert 0.005 < measurement.lost < 0.1
    assert measurement.turned_deg == 0
    assert np.isfinite(measurement.height_um).all()


def test_the_shipped_map_can_be_made_again_and_says_that_it_is_made(tmp_path: Path) -> None:
    assert main(["artificial", "--out", str(tmp_path / "again.x3p")]) == 0
    assert (tmp_path / "again.x3p").read_bytes() == SHIPPED.read_bytes()
    assert "NOT MEASURED" in NOTE


def test_x3p_keeps_heights_and_lost_points(tmp_path: Path, planted: Array) -> None:
    valid = np.random.default_rng(0).random(planted.shape) > 0.3
    write_x3p(tmp_path / "a.x3p", planted, valid, step_um=5.0, note="a test")
    found = read_measurement(tmp_path / "a.x3p")
    assert found.step_um == pytest.approx(5.0)
    assert found.lost == pytest.approx(1 - valid.mean(), abs=1e-6)
    away = found.height_um - planted
    assert np.ptp(away[valid]) < 3 * HEIGHT_STEP_UM + 1.0  # the plane taken off
    assert np.abs(away[~valid] - np.median(away)).max() < 6  # filled from the neighbours


def test_tilt_is_taken_off(tmp_path: Path, planted: Array) -> None:
    y, x = np.indices(planted.shape)
    np.save(tmp_path / "tilted.npy", planted + 0.05 * x - 0.02 * y + 700)
    np.save(tmp_path / "flat.npy", planted)
    tilted, flat = (read_measurement(tmp_path / f"{name}.npy", 5.0).height_um for name in ("tilted", "flat"))
    assert np.abs(tilted - flat).max() < 0.2


@pytest.mark.parametrize("angle", [90, 30, -55])
def test_a_weld_at_any_angle_is_laid_along_x(angle: int, tmp_path: Path, planted: Array) -> None:
    square = np.tile(planted, (1, 2))[:, :600].astype(np.float32)
    big = cv2.copyMakeBorder(square, 300, 300, 300, 300, cv2.BORDER_WRAP)
    big[:500], big[-500:] = planted[:1, :1], planted[:1, :1]
    matrix = cv2.getRotationMatrix2D((600, 600), -angle, 1.0)
    np.save(
        tmp_path / "turned.npy",
        cv2.warpAffine(big, matrix, (1200, 1200), borderMode=cv2.BORDER_REFLECT)[200:1000, 200:1000],
    )
    found = read_measurement(tmp_path / "turned.npy", 5.0)
    assert abs((found.turned_deg - angle + 90) % 180 - 90) <= 2


def broken(folder: Path) -> dict[str, tuple[Path, float | None, str]]:
    rng = np.random.default_rng(0)
    maps = {
        "lost": (np.full((300, 300), np.nan), 3.0, "0% of the points"),
        "scaled": (rng.normal(size=(300, 300)) * 1e6, 3.0, "heights span"),
        "coarse": (rng.normal(size=(300, 300)), 300.0, "step is 300 um; 0.1 to 50"),
        "small": (rng.normal(size=(20, 300)), 3.0, "0.06 mm; 0.5 to 50 mm"),
        "flat": (rng.normal(size=(3, 30, 30)), 3.0, "shape (3, 30, 30)"),
        "stepless": (rng.normal(size=(300, 300)), None, "--step-um"),
    }
    cases: dict[str, tuple[Path, float | None, str]] = {}
    for name, (values, step, said) in maps.items():
        np.save(folder / f"{name}.npy", values)
        cases[name] = (folder / f"{name}.npy", step, said)
    (folder / "empty.x3p").touch()
    (folder / "text.x3p").write_text("no measurement")
    (folder / "half.x3p").write_bytes(SHIPPED.read_bytes()[:5000])
    (folder / "text.npy").write_text("no numbers")
    cases["empty"] = folder / "empty.x3p", None, "empty"
    cases["text"] = folder / "text.x3p", None, "not a readable surface measurement"
    cases["half"] = folder / "half.x3p", None, "not a readable surface measurement"
    cases["no numbers"] = folder / "text.npy", 3.0, "not a readable npy"
    cases["absent"] = folder / "absent.x3p", None, "no such file"
    cases["step of its own"] = SHIPPED, 3.0, "states its own step"
    return cases


def test_unfit_files_are_refused_with_the_value_and_the_range(tmp_path: Path) -> None:
    for name, (path, step, said) in broken(tmp_path).items():
        with pytest.raises(SynthError) as caught:
            read_measurement(path, step)
        assert said in str(caught.value), name
        assert str(path) in str(caught.value)
        assert "\n" not in str(caught.value)
