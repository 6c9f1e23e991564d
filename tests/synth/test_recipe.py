"""Recipes and switches from the command line and from files; mistakes are said in one line."""

from pathlib import Path

import pytest

from synth.__main__ import main
from synth.errors import SynthError
from synth.part.recipe import LINE, PAPER, RECIPES, WIDE, read_recipe
from synth.part.switches import ALL, Switch, without


def test_a_file_changes_what_it_names(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('base = "wide"\nspatter = [1, 2]\nmaterial = "copper"\n')
    found = read_recipe(path, LINE)
    assert found.spatter == (1, 2)
    assert found.material == "copper"
    assert found.gap_mm == WIDE.gap_mm


@pytest.mark.parametrize("name", RECIPES)
def test_every_recipe_keeps_its_own_limits(name: str, tmp_path: Path) -> None:
    path = tmp_path / "same.toml"
    path.write_text(f'base = "{name}"\n')
    assert read_recipe(path, PAPER) == RECIPES[name]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("spater = [1, 2]", "spater: no such key; known: base, material"),
        ("gap_mm = [0.3, 0.1]", "gap_mm: [0.3, 0.1] is not allowed; 0.01 to 0.5"),
        ("soot = [0, 7]", "soot: [0.0, 7.0] is not allowed; 0 to 1"),
        ('material = "gold"', "material"),
        ("base = 1", "no such recipe; known: line, dense, wide, paper"),
        ("shift_mm = 'far'", "shift_mm"),
        ("= 3", "not a readable recipe"),
    ],
)
def test_a_wrong_file_is_refused_with_key_value_and_range(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(SynthError) as caught:
        read_recipe(path, LINE)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_switches_are_switched_off_by_name() -> None:
    assert without([]) == ALL
    assert without(["perlin", "soot-on-weld"]) == ALL - {Switch.PERLIN, Switch.SOOT_ON_WELD}
    assert len(ALL) == 8


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["dataset", "--count", "0"], "--count is 0; 1 to"),
        (["dataset", "--workers", "0"], "--workers is 0; 1 to 256"),
        (["dataset", "--seed", "-1"], "--seed is -1; 0 to"),
        (["dataset", "--off", "perlyn"], "--off perlyn: no such switch; known: topography"),
        (["dataset", "--recipe", "/nowhere.toml"], "/nowhere.toml: not a readable recipe"),
        (["dataset", "--measurement", "/nowhere.x3p"], "/nowhere.x3p: no such file"),
        (["part", "--count", "0"], "--count is 0"),
        (["sheet", "/nowhere"], "no finished dataset"),
        (["calibrate", "/nowhere.png"], "not a readable image"),
    ],
)
def test_mistakes_are_said_in_a_line(arguments: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*arguments, "--out", str(tmp_path / "out.png")]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
