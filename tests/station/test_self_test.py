"""The self-test is on by default, runs on a busy line too, and `weldgate check` says what is off."""

import tomllib
from pathlib import Path
from types import SimpleNamespace

import pytest

from station.cli.check import switched_off
from station.engine import self_checks
from station.engine.self_checks import SelfChecks
from station.inspection.loading import Loaded, prepare
from station.settings.model import Settings
from tests.conftest import MODEL, RING_MODEL, SEEN_MODEL
from tests.parts import ok_inspection, provenance

NETWORKS = f'path = "{MODEL}"\nring_path = "{RING_MODEL}"\nseen_path = "{SEEN_MODEL}"\n'
CAMERA = '[camera]\nkind = "pylon"\ndevice_class = "BaslerCamEmu"\nserial = "0815-0000"\n'
EXAMPLE = Path(__file__).parents[2] / "deploy" / "station.toml"


def settings_of(text: str) -> Settings:
    return Settings.model_validate(tomllib.loads(text))


def test_the_self_test_is_on_without_settings() -> None:
    loaded = prepare(settings_of(f"{CAMERA}[model]\n{NETWORKS}"), 1)
    assert loaded.self_test is not None
    assert loaded.self_test.passes()


def test_the_frame_that_the_example_names_passes_with_the_verdict_that_it_names(tmp_path: Path) -> None:
    lines = [
        line.removeprefix("# ").split("#")[0].strip()
        for line in EXAMPLE.read_text().splitlines()
        if "self_test_path =" in line or "self_test_verdict =" in line
    ]
    assert len(lines) == 2
    text = "\n".join(lines).replace("frames/", f"{EXAMPLE.parent}/frames/")
    assert prepare(settings_of(f"{CAMERA}[model]\n{NETWORKS}{text}\n"), 1).self_test is not None


def test_a_weld_that_the_shipped_frame_does_not_fit_is_judged_without_it_and_check_says_so(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "station.toml"
    path.write_text(f"{CAMERA}[weld]\nradius_mm = 3.0\n[model]\n{NETWORKS}")
    off = switched_off(path)
    assert "there is no self-test" in caplog.text
    assert off[0].startswith("self-test of recipe 1: the shipped frame does not fit the weld")
    assert [line.split(" ")[0] for line in off[1:]] == ["master", "drift"]
    path.write_text(f'{CAMERA}[model]\n{NETWORKS}[golden.masters]\nA = "OK"\n')
    assert [line.split(" ")[0] for line in switched_off(path)] == ["masters", "drift"]


class Stored:
    """A self-test that counts its runs."""

    def __init__(self) -> None:
        self.runs, self.right = 0, True

    def passes(self) -> bool:
        self.runs += 1
        return self.right


def test_on_a_busy_line_it_runs_between_parts_at_its_age(monkeypatch: pytest.MonkeyPatch) -> None:
    """A part each second for an hour, never a pause."""
    now = [1000.0]
    monkeypatch.setattr(self_checks.time, "monotonic", lambda: now[0])
    stored, inspector = Stored(), SimpleNamespace(reference=None)
    loaded = Loaded(1, inspector, provenance(), stored)  # type: ignore[arg-type]
    checks = SelfChecks(loaded, {}, None, 10.0, self_test_age_s=300.0)
    for _ in range(3600):
        now[0] += 1
        checks.part_judged(ok_inspection())
        checks.run_between_parts()
        checks.run_when_idle()
    assert stored.runs == 12
    stored.right = False
    now[0] += 300
    checks.run_between_parts()
    assert checks.self_test_failed
    assert not checks.trusted
    stored.right = True
    now[0] += 1
    checks.run_when_idle()
    assert checks.trusted


@pytest.mark.parametrize("has_self_test", [True, False])
def test_another_recipe_does_not_make_good_a_self_test_that_failed(has_self_test: bool) -> None:
    stored, inspector = Stored(), SimpleNamespace(reference=None)
    stored.right = False
    loaded = Loaded(1, inspector, provenance(), stored)  # type: ignore[arg-type]
    checks = SelfChecks(loaded, {}, None, 10.0, self_test_age_s=0.0)
    checks.run_between_parts()
    assert not checks.trusted

    other = Stored()
    checks.use(Loaded(2, inspector, provenance(), other if has_self_test else None))  # type: ignore[arg-type]
    assert not checks.trusted
    checks.run_between_parts()
    assert checks.trusted == has_self_test
    assert other.runs == int(has_self_test)
