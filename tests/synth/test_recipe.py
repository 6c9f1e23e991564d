"""Recipes and switches from the command line and from files; mistakes are said in one line."""

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from synth.__main__ import main
from synth.errors import SynthError
from synth.part.switches import ALL, Switch, without
from synth.recipes.named import LINE, PAPER, RECIPES, WIDE
from synth.recipes.toml_file import OLD_KEYS, read_recipe


def test_a_file_changes_what_it_names(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(
        'base = "wide"\nok_weight = 2\n[dirt]\nspatter = [1, 2]\n[surface]\nmaterial = "copper"\n'
        "[hole]\nlength_mm = [0.5, 1.0]\nweight = 0.0\n"
    )
    found = read_recipe(path, LINE)
    assert found.ok_weight == 2
    assert found.dirt.spatter == (1, 2)
    assert found.surface.material == "copper"
    assert found.joint == WIDE.joint
    assert found.defects["missing_weld"] == WIDE.defects["missing_weld"]
    hole = found.tables()["hole"]
    assert hole == {**asdict(WIDE.defects["hole"]), "length_mm": (0.5, 1.0), "weight": 0.0}


@pytest.mark.parametrize("name", RECIPES)
def test_every_recipe_keeps_its_own_limits(name: str, tmp_path: Path) -> None:
    path = tmp_path / "same.toml"
    path.write_text(f'base = "{name}"\n')
    assert read_recipe(path, PAPER) == RECIPES[name]
    tables = json.loads(json.dumps(RECIPES[name].tables()))
    lines = [f"ok_weight = {tables.pop('ok_weight')}"]
    for group, values in tables.items():
        lines += [f"[{group}]", *(f"{key} = {json.dumps(value)}" for key, value in values.items())]
    path.write_text("\n".join(lines))
    assert read_recipe(path, PAPER) == RECIPES[name]


def test_a_file_of_an_older_version_is_read(tmp_path: Path) -> None:
    path = tmp_path / "old.toml"
    tables = RECIPES["wide"].tables()
    values = {old: tables[group][key] for old, (group, key) in OLD_KEYS.items()}
    path.write_text("".join(f"{key} = {json.dumps(value)}\n" for key, value in values.items()))
    assert read_recipe(path, PAPER).groups().keys() == WIDE.groups().keys()
    found, expected = read_recipe(path, PAPER).tables(), WIDE.tables()
    for group in {group for group, _ in OLD_KEYS.values()}:
        assert {**found[group], "weight": 0} == {**expected[group], "weight": 0}
    path.write_text("holes = [2, 2]\nspectral_share = 0.5\n[hole]\nlength_mm = [0.5, 1.0]\n")
    mixed = read_recipe(path, LINE)
    assert mixed.tables()["hole"]["count"] == (2, 2)
    assert mixed.tables()["hole"]["length_mm"] == (0.5, 1.0)
    assert mixed.relief.spectral_fraction == 0.5


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("spater = [1, 2]", "spater: no such key; known: base, ok_weight, [pose], [bead]"),
        (
            "[dirt]\nspater = [1, 2]",
            "dirt.spater: no such key; known: soot, soot_softness, heat_tint, spatter",
        ),
        ("[hole]\ncolour = 1", "hole.colour: no such key; known: weight, count, length_mm"),
        ("gap_mm = [0.3, 0.1]", "joint.gap_mm: [0.3, 0.1] is not allowed; 0.01 to 0.5"),
        ("[joint]\ngap_mm = [0.3, 0.1]", "joint.gap_mm: [0.3, 0.1] is not allowed; 0.01 to 0.5"),
        ("[dirt]\nsoot = [0, 7]", "dirt.soot: [0.0, 7.0] is not allowed; 0 to 1"),
        ('[surface]\nmaterial = "gold"', "surface.material"),
        ("base = 1", "no such recipe; known: line, dense, wide, paper"),
        ("[pose]\nshift_mm = 'far'", "pose.shift_mm"),
        ("ok_weight = -1", "ok_weight: -1.0 is not allowed; 0 to 1000"),
        ("bead = 3", "bead = 3: is a table of ranges; write [bead]"),
        (
            "holes = [1, 2]\n[hole]\ncount = [1, 3]",
            "holes: is the older name of hole.count, which is given too",
        ),
        ("holes = [1, 2]\nhole = 3", "hole = 3: is a table of ranges"),
        ("= 3", "not a readable recipe"),
    ],
)
def test_a_wrong_file_is_refused_with_key_value_and_range(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(SynthError) as caught:
        read_recipe(path, LINE)
    assert said in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("command", ["dataset", "part", "sheet", "measurement", "artificial", "calibrate"])
def test_help_names_the_groups_of_a_recipe_file(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main([command, "--help"])
    shown = capsys.readouterr().out
    if "--recipe" in shown:
        assert all(group in shown.split("Groups:")[1] for group in LINE.groups())


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
def test_mistakes_are_said_in_a_line(
    arguments: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*arguments, "--out", str(tmp_path / "out.png")]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
