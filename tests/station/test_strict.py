"""Text that comes in is taken for what it says: nothing is turned into a number that is none."""

import ast
import json
import tomllib
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from deploy.demo.run import main as demo
from station.__main__ import main
from station.analysis.truth import read_truth
from station.channel.request_socket import _MESSAGE
from station.errors import RecordError, SettingsError
from station.numbers import number, number_key, numbered, whole
from station.settings.camera import PylonSettings
from station.settings.file import load
from station.settings.model import Settings
from station.settings.section import Section
from synth.errors import SynthError
from synth.recipes.named import LINE
from synth.recipes.toml_file import read_recipe
from tests.conftest import ROOT

GOOD = '[camera]\nkind = "pylon"\nserial = "1"\n'
WRONG: dict[type, tuple[Any, ...]] = {
    float: (True, "1", "0.6", float("nan"), float("inf"), [1], {}),
    int: (True, "1", 1.5, 2.0, float("nan"), [1]),
    bool: (0, 1, "true", "yes", 1.0),
    Path: (1, True, 0.5, ["a"], {}),
    str: (1, True, 0.5, ["a"]),
}
"""Values that are no value of a type, although one could be made of them."""


def _bare(kind: Any) -> list[Any]:
    """Return the types of a field, without metadata."""
    if get_origin(kind) is Annotated:
        return _bare(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return [one for part in get_args(kind) for one in _bare(part)]
    return [kind]


def leaves(section: type[Section], place: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], type]]:
    for name, info in section.model_fields.items():
        for kind in _bare(info.annotation):
            if isinstance(kind, type) and issubclass(kind, Section):
                yield from leaves(kind, (*place, name))
            elif kind in WRONG and name != "kind":
                yield (*place, name), kind


LEAVES = [(("camera", name), kind) for (name,), kind in leaves(PylonSettings)] + [
    (place, kind)
    for place, kind in leaves(Settings)
    if place[0] not in ("camera", "panel") or kind is not str
]
CASES = [(place, value) for place, kind in dict.fromkeys(LEAVES) for value in WRONG[kind]]


def test_there_are_cases_for_every_section() -> None:
    assert {place[0] for place, _ in CASES} >= {
        *("camera", "weld", "quality", "model", "plc", "archive", "channel", "golden", "panel"),
    }


@pytest.mark.parametrize(("place", "value"), CASES, ids=lambda value: str(value))
def test_no_setting_takes_a_value_of_another_type(place: tuple[str, ...], value: Any) -> None:
    raw: dict[str, Any] = {"camera": {"kind": "pylon", "serial": "1"}}
    inner = raw
    for name in place[:-1]:
        inner = inner.setdefault(name, {})
    inner[place[-1]] = value
    if place[:2] == ("plc", "tls"):
        inner.update({f"{name}_path": "a" for name in ("certificate", "key", "ca") if name not in place[-1]})
    if place[-1].startswith("self_test_"):
        inner.setdefault("self_test_path", "a")
        inner.setdefault("self_test_verdict", "OK")
    with pytest.raises(ValidationError):
        Settings.model_validate(raw)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("[model]\nhole_threshold = true\n", "model.limits.hole.threshold"),
        ("[plc]\nplc_heartbeat_ms = false\n", "plc.plc_heartbeat_ms"),
        (
            "[recipes.02]\nweld = { radius_mm = 5.0 }\n[recipes.2]\nweld = { radius_mm = 5.5 }\n",
            "'02' is not",
        ),
        ("[model.segment_thresholds]\n1 = 0.5\n01 = 0.7\n", "'01' is not"),
        ("[recipes.2]\nmodel = { threads = true }\n", "threads"),
        ("[recipes.2.model.segment_thresholds]\n'٣' = 0.7\n", "'٣' is not"),
        ("[plc]\nallow = [5]\n", "plc.allow"),
        ("[channel]\nfolder = 2130706433\n", "channel.folder"),
        ("[weld]\nradius_mm = inf\n", "weld.radius_mm"),
    ],
)
def test_silent_values_are_refused_with_their_place(text: str, part: str, tmp_path: Path) -> None:
    (tmp_path / "station.toml").write_text(GOOD + text)
    with pytest.raises(SettingsError, match=part):
        load(tmp_path / "station.toml")


def test_changes_at_the_station_are_as_strict(tmp_path: Path) -> None:
    (tmp_path / "station.toml").write_text(GOOD)
    for changes in (
        '{"camera": {"gain_db": true}}',
        '{"camera": {"gain_db": 1, "gain_db": 2}}',
        '{"recipes": {"02": {"weld": {"radius_mm": 5.5}}}}',
        '{"recipes": {"1": {"quality": {"min_sharpness": NaN}}}}',
    ):
        (tmp_path / "station.adjusted.json").write_text(changes)
        with pytest.raises(SettingsError, match=r"adjusted\.json"):
            load(tmp_path / "station.toml")


@pytest.mark.parametrize(
    "request_text",
    [
        '{"type": "acknowledge", "number": true}',
        '{"type": "acknowledge", "number": "7"}',
        '{"type": "stay logged in", "touched": "yes"}',
        '{"type": "hold service", "look": 1}',
        '{"type": "hold service", "exposure_us": "100"}',
        '{"type": "hold service", "gain_db": true}',
        '{"type": "give review", "inspection_id": 1.0, "opinion": "right"}',
        '{"type": "save user", "name": "A", "level": true, "pin": "1234"}',
    ],
)
def test_requests_are_strict(request_text: str) -> None:
    text = f'{{"request_id": 1, "sent_s": 1.0, "request": {request_text}}}'
    with pytest.raises(ValidationError):
        _MESSAGE.validate_json(text, strict=True)


@pytest.mark.parametrize("value", ["true", "[true, 1.0]", '["0.1", 0.2]', "[nan, 1]", "[0, inf]"])
def test_a_recipe_of_the_generator_is_strict(value: str, tmp_path: Path) -> None:
    (tmp_path / "r.toml").write_text(f"[sensor]\nexposure = {value}\n")
    with pytest.raises(SynthError, match=r"sensor\.exposure"):
        read_recipe(tmp_path / "r.toml", LINE)


def test_a_truth_that_names_a_part_twice_is_refused(tmp_path: Path) -> None:
    (tmp_path / "truth.json").write_text('{"a": "OK", "a": "NOK"}')
    with pytest.raises(RecordError, match=r"truth\.json"):
        read_truth(tmp_path / "truth.json")


@given(st.floats(-1e9, 1e9), st.sampled_from(",."))
def test_a_number_is_read_with_either_decimal_sign(value: float, sign: str) -> None:
    text = f"{value:.6f}"
    assert number(text.replace(".", sign)) == float(text)


@given(st.text(max_size=12))
def test_a_text_is_a_number_only_if_every_reader_agrees(text: str) -> None:
    try:
        value = number(text)
    except ValueError:
        return
    assert text.isascii()
    assert value == float(text.replace(",", "."))


@pytest.mark.parametrize("text", ["", "1_0", "nan", "inf", "1e999", "٣", "0x1", "1.", ".5", "1,2,3", "1 2"])
def test_what_is_no_number_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="not a number"):
        number(text)


@pytest.mark.parametrize("text", ["", "1_0", "1.0", "1,5", "٣", "0x1", "1e3", "9" * 19])
def test_what_is_no_whole_number_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="whole number"):
        whole(text)


@given(
    st.dictionaries(
        st.integers(1, 21), st.floats(0.01, 0.99).map(lambda value: round(value, 3)), max_size=21
    ),
    st.sampled_from([", ", "; ", ",", ";"]),
    st.sampled_from(".,"),
)
def test_values_of_segments_are_read_with_either_sign(
    limits: dict[int, float], between: str, sign: str
) -> None:
    text = between.join(f"{key}: {value:.3f}".replace(".", sign) for key, value in limits.items())
    assert numbered(text) == limits


@pytest.mark.parametrize("text", ["1: 0.6, 1: 0.7", "1: 0,6; 1: 0,6", "1 0.6", "x: 1", "1: 0.5 2: 0.5", "1:"])
def test_segments_named_twice_or_otherwise_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"twice|such as"):
        numbered(text)


@given(st.text(max_size=4))
def test_a_key_has_one_form(text: str) -> None:
    try:
        key = number_key(text)
    except ValueError:
        return
    assert str(key) == text


def test_options_of_commands_read_numbers_alike() -> None:
    """No option uses int or float itself, which take 1_000, NaN and digits of other scripts."""
    for room in ("station", "synth", "models", "deploy"):
        for path in (ROOT / room).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.keyword) and node.arg == "type" and isinstance(node.value, ast.Name):
                    assert node.value.id not in ("int", "float"), f"{path}:{node.value.lineno}"


def test_an_option_with_a_decimal_comma_is_read(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["records", "list", str(tmp_path), "--score", "0,5"]) == 2
    assert "no records found" in capsys.readouterr().err
    for option in (("--score", "nan"), ("--last", "1_0"), ("--last", "0"), ("--score", "2")):
        with suppress(SystemExit):  # argparse ends the command itself
            assert main(["records", "list", str(tmp_path), *option]) == 2
        assert "no records found" not in capsys.readouterr().err


@pytest.mark.parametrize("port", ["0", "65536", "-1", "1502.0", "all"])
@pytest.mark.parametrize("command", [["line"], ["demo", "--station"]])
def test_a_wrong_port_is_refused_in_a_short_line(
    command: list[str], port: str, capsys: pytest.CaptureFixture[str]
) -> None:
    run, options = (main, command) if command[0] == "line" else (demo, command[1:])
    with pytest.raises(SystemExit) as ended:
        run([*options, "--port", port])
    assert ended.value.code == 2
    line = capsys.readouterr().err.splitlines()[-1]
    assert "--port" in line
    assert len(line) < 120


def test_the_example_is_strict() -> None:
    raw = tomllib.loads((ROOT / "deploy" / "station.toml").read_text())
    assert Settings.model_validate(raw)
    assert json.dumps(raw)
