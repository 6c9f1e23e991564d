from pathlib import Path

import pytest

from station.errors import SettingsError
from station.settings.camera import PylonSettings, ReplaySettings
from station.settings.file import load
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
        (GOOD + '[channel]\nhost = "nowhere"\n', "channel.host"),
        (GOOD + '[channel]\nhost = "192.168.1.5"\n', "channel.host: must be a loopback address"),
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
