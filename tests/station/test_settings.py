from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.cli.check import check
from station.domain import TRAINED_UM_PER_PX, Ring
from station.errors import SettingsError
from station.files.image import encode_png
from station.settings.camera import PylonSettings, ReplaySettings
from station.settings.file import load
from station.settings.model import WeldSettings
from station.settings.view import view_problem
from station.vision.unwrap import in_view
from tests.conftest import ROOT

GOOD = '[camera]\nkind = "pylon"\nserial = "1"\n'


def test_the_example_loads_and_its_paths_count_from_its_folder() -> None:
    settings = load(ROOT / "deploy" / "station.toml")
    assert isinstance(settings.camera, PylonSettings)
    assert settings.model.path.resolve() == ROOT / "models" / "shipped" / "weldgate.onnx"


def test_every_path_counts_from_the_folder_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "station.toml"
    path.write_text(
        '[camera]\nkind = "replay"\nfolder = "images"\n[archive]\nfolder = "kept"\n[model]\npath = "a.onnx"\n'
        '[plc.tls]\ncertificate_path = "a.pem"\nkey_path = "a.key"\nca_path = "ca.pem"\n'
        '[recipes.2]\nmodel = { path = "b.onnx" }\n'
    )
    settings = load(path)
    assert isinstance(settings.camera, ReplaySettings)
    assert settings.plc.tls is not None
    tls = settings.plc.tls
    found = [settings.camera.folder, settings.archive.folder, settings.model.path, settings.model.ring_path]
    found += [tls.certificate_path, tls.key_path, tls.ca_path, settings.recipes[2].model["path"]]
    names = ["images", "kept", "a.onnx", "ring.onnx", "a.pem", "a.key", "ca.pem", "b.onnx"]
    assert found == [tmp_path / name for name in names]
    assert settings.model.self_test_path is None


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("", "camera"),
        ("[camera", "not valid TOML"),
        ('[camera]\nkind = "webcam"\n', "kind"),
        ('[camera]\nkind = "pylon"\nserial = ""\n', r": camera\.serial: "),
        ('[camera]\nkind = "replay"\n', r": camera\.folder: "),
        (GOOD + "exposure_us = -1\n", "exposure_us"),
        (GOOD + "expsure_us = 5\n", "expsure_us"),
        (GOOD + "[plc]\nport = 70000\n", "plc.port"),
        (GOOD + "[model]\nhole_threshold = 1.5\n", "model.limits.hole.threshold"),
        (
            GOOD + "[model.limits.crakc]\nthreshold = 0.5\n",
            "unknown kind of defect 'crakc'; known: hole, ",
        ),
        (GOOD + "[weld]\num_per_px = 5\n", "weld.um_per_px: the networks are trained for 9 to 65 µm/px, not"),
        (
            GOOD + "[recipes.2]\nweld = { um_per_px = 66 }\n",
            "networks are trained for 9 to 65 µm/px, not for 66",
        ),
        (
            GOOD + "[weld]\nradius_mm = 20\n",
            "recipe 1: images of 4200 x 2160 px are too small for a radius of 20",
        ),
        (
            GOOD + "width_px = 1600\nheight_px = 1600\n[recipes.2]\nweld = { radius_mm = 9.5 }\n",
            "recipe 2: images of 1600 x 1600 px are too small for .* which needs 1615 x 1615 px",
        ),
        (GOOD + "[channel]\nevents_port = 15551\n", "channel: events_port: no longer used"),
    ],
)
def test_mistakes_are_named_with_file_and_key(text: str, part: str, tmp_path: Path) -> None:
    path = tmp_path / "station.toml"
    path.write_text(text)
    with pytest.raises(SettingsError, match=part) as caught:
        load(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_file_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="settings file not found"):
        load(tmp_path / "none.toml")


@given(st.floats(1, 30), st.floats(0.01, 0.5), st.floats(*TRAINED_UM_PER_PX), st.integers(100, 5000))
def test_a_weld_that_is_accepted_can_be_in_view_and_one_pixel_less_is_refused(
    radius_mm: float, tolerance_mm: float, um_per_px: float, larger_px: int
) -> None:
    weld = WeldSettings(radius_mm=radius_mm, radius_tolerance_mm=tolerance_mm, um_per_px=um_per_px)
    needed = next(side for side in range(10, 9000) if view_problem(weld, side, side + larger_px) is None)
    middle, radius_px = (needed - 1) / 2, (radius_mm + tolerance_mm) * 1000 / um_per_px
    largest = Ring(middle, middle, radius_px * (1 - 1e-9), 1.0)
    assert in_view(largest, needed, needed, um_per_px=um_per_px)
    assert not in_view(replace(largest, radius_px=radius_px + 1e-6), needed - 1, needed, um_per_px=um_per_px)


@pytest.mark.parametrize("size", [(4200, 2160), (400, 400)])
def test_check_names_the_scale_and_the_images_that_are_too_small(
    size: tuple[int, int], tmp_path: Path
) -> None:
    (tmp_path / "images").mkdir()
    (tmp_path / "images" / "a.png").write_bytes(encode_png(np.zeros(size[::-1], np.uint8)))
    path = tmp_path / "station.toml"
    path.write_text(
        '[camera]\nkind = "replay"\nfolder = "images"\n[weld]\num_per_px = 26\n[plc]\nport = 1\n'
        "[recipes.2]\nweld = { um_per_px = 13.5 }\n"
    )
    found = dict(check(path))
    assert found["settings"] is None
    assert found["scale 13.5 and 26 µm/px, trained for 9 to 65"] is None
    if size == (4200, 2160):
        assert found["camera"] is None
    else:
        assert "recipe 1: images of 400 x 400 px are too small" in str(found["camera"])
