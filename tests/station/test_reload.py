"""Settings that need a restart are named, and one change at the station takes over no other one."""

from pathlib import Path

import pytest

from station.errors import SettingsError
from station.inspection.loading import Loaded
from station.settings import adjustments
from station.settings.differences import AT_START, differences, need_restart
from station.settings.file import load
from station.settings.model import Settings
from tests.station.test_settings_change import NEW, Engine, engine, path, quick

__all__ = ["engine", "path", "quick"]

FIXED = [
    ("[plc]\ndeadline_ms = 1000", "plc.deadline_ms"),
    ('[archive]\nfolder = "elsewhere"', "archive.folder"),
    ("[archive.keep]\nnok_days = 3", "archive.keep.nok_days"),
    ('[golden.masters]\nA = "OK"', "golden.masters.A"),
    ("[golden]\ndue_h = 8", "golden.due_h"),
]
"""What is added to the file, and the setting that only a restart takes up."""


@pytest.mark.parametrize(("text", "name"), FIXED, ids=[name for _text, name in FIXED])
def test_a_reload_names_what_needs_a_restart_and_uses_nothing(
    engine: Engine, quick: Loaded, text: str, name: str
) -> None:
    before = engine.active.settings
    engine.path.write_text(f"{engine.path.read_text()}\n[quality]\nmin_sharpness = 0.3\n{text}\n")
    with pytest.raises(SettingsError, match=rf"^{name}: .*after a restart"):
        engine.active.prepare_file(1)
    assert engine.active.settings == before


def test_a_reload_uses_all_that_needs_no_restart(engine: Engine, quick: Loaded) -> None:
    engine.path.write_text(f"{engine.path.read_text()}\n[quality]\nmin_sharpness = 0.3\n")
    engine.active.activate(engine.active.prepare_file(1))
    assert engine.active.settings == load(engine.path)


def test_a_change_at_the_station_takes_over_no_edit_of_the_file(engine: Engine, quick: Loaded) -> None:
    before = engine.active.settings
    engine.path.write_text(f"{engine.path.read_text()}\n[quality]\nmin_mean_dn = 2.0\n")
    with pytest.raises(SettingsError, match=r"^quality\.min_mean_dn: edited in the settings file"):
        engine.change_to(0.02)
    assert engine.active.settings == before
    assert not adjustments.read(engine.path)
    assert not engine.noted()
    engine.active.activate(engine.active.prepare_file(1))
    engine.change_to(0.02)
    assert adjustments.read(engine.path) == NEW


def test_differences_are_named_and_those_of_a_start_are_separate(path: Path) -> None:
    base = load(path)
    for fixed in AT_START:
        assert _has(base, fixed), fixed
    other = base.model_copy(
        update={
            "plc": base.plc.model_copy(update={"port": 1}),
            "weld": base.weld.model_copy(update={"radius_mm": 4.0}),
        }
    )
    assert not differences(base, base)
    assert sorted(differences(base, other)) == ["plc.port", "weld.radius_mm"]
    assert need_restart(base, other) == ["plc.port"]


def _has(settings: Settings, name: str) -> bool:
    found: object = settings
    for part in name.split("."):
        found = getattr(found, part, None)
    return found is not None
