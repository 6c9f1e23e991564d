import re
from enum import IntFlag

import pytest
import tree_sitter_iec61131_3_st
from hypothesis import given
from hypothesis import strategies as st
from tree_sitter import Language, Parser

from station import __version__
from station.__main__ import main
from station.plc.block.definition import VARIABLES
from station.plc.block.dialects import scl, structured_text, symbols
from station.plc.handshake_state import State
from station.plc.map import status_window
from station.plc.map.document import as_csv
from station.plc.map.registers import (
    BY_NAME,
    COMMAND_START,
    COMMAND_WORDS,
    MAP,
    STATUS_START,
    STATUS_WORDS,
    Control,
    Flags,
    Offline,
    Status,
    all_bits,
    named_bits,
    pack,
    pack_window,
    reordered,
    unpack,
    unpack_window,
)
from station.plc.port import Counts, Health
from tests.conftest import ROOT


def test_registers_fill_their_windows_without_overlap() -> None:
    taken = [a for r in MAP for a in range(r.address, r.address + r.words)]
    assert sorted(taken) == [*range(COMMAND_WORDS), *range(STATUS_START, STATUS_START + STATUS_WORDS)]


@given(st.sampled_from([r for r in MAP if r.kind in ("u16", "u32")]), st.data())
def test_numbers_come_back(register: object, data: st.DataObject) -> None:
    from station.plc.map.registers import Register

    assert isinstance(register, Register)
    top = 0xFFFF if register.kind == "u16" else 0xFFFFFFFF
    value = data.draw(st.tuples(*[st.integers(0, top)] * register.count))
    one = value[0] if register.count == 1 else value
    assert unpack(register, pack(register, one)) == one


@given(st.text(st.characters(min_codepoint=33, max_codepoint=126), max_size=32))
def test_serials_come_back(serial: str) -> None:
    register = BY_NAME["PART_SERIAL"]
    assert unpack(register, pack(register, serial)) == serial


def test_word_order_is_high_first() -> None:
    assert pack(BY_NAME["TEST_U32"], 0x12345678) == [0x1234, 0x5678]
    assert pack(BY_NAME["TEST_F32"], 123.456) == [0x42F6, 0xE979]
    assert pack(BY_NAME["PART_SERIAL"], "AB")[0] == 0x4142


@pytest.mark.parametrize(
    ("name", "value"),
    [("VERDICT", 70000), ("VERDICT", -1), ("PART_SERIAL", "x" * 33), ("SEG_SCORE", (1, 2)), ("VERDICT", "1")],
)
def test_what_does_not_fit_is_refused(name: str, value: object) -> None:
    with pytest.raises(ValueError, match=name):
        pack(BY_NAME[name], value)  # type: ignore[arg-type]


def test_a_window_of_zeros_says_no_verdict() -> None:
    values = unpack_window(STATUS_START, pack_window(STATUS_START, STATUS_WORDS, {}))
    assert values["VERDICT"] == 0
    assert values["VERDICT_INV"] == 0


@pytest.mark.parametrize(
    ("form", "name"),
    [
        ("md", "register_map.md"),
        ("block", "block.md"),
        ("plcopen", "weldgate_plcopen.xml"),
        ("openplc", "weldgate_openplc.st"),
        ("st", "weldgate.st"),
        ("scl", "weldgate.scl"),
        ("symbols", "weldgate_symbols.csv"),
    ],
)
def test_the_files_for_plc_tools_are_those_of_the_definition(
    form: str, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["registers", "--format", form]) == 0
    path = ROOT / "deploy" / "plc" / name
    assert path.read_text() == capsys.readouterr().out, (
        f"run: weldgate registers --format {form} > deploy/plc/{name}"
    )


def test_the_page_for_integrators_names_the_windows_and_registers_of_the_map() -> None:
    page = " ".join((ROOT / "deploy" / "plc" / "README.md").read_text().split())
    for said in (
        f"the whole status window, from {STATUS_START} to the last",
        f"the command window, from {COMMAND_START},",
        f"outside registers {COMMAND_START} to {COMMAND_START + COMMAND_WORDS - 1} is refused",
        f"Read four registers from {BY_NAME['TEST_U32'].address}",
        f"ENABLE (register {BY_NAME['CONTROL'].address}, bit {Control.ENABLE.bit_length() - 1})",
        f"PLC_HEARTBEAT (register {BY_NAME['PLC_HEARTBEAT'].address})",
        f"OFFLINE_REASON ({BY_NAME['OFFLINE_REASON'].address})",
    ):
        assert said in page, f"deploy/plc/README.md must say: {said}"


@pytest.mark.parametrize("flags", [Control, Status, Flags])
@given(st.integers(0, 0xFFFF))
def test_bits_with_a_name_pass_and_others_are_ignored(flags: type[IntFlag], register: int) -> None:
    found = named_bits(flags, register)
    assert [bit in found for bit in flags] == [bool(register & bit) for bit in flags]
    assert found in all_bits(flags)
    assert named_bits(flags, 0xFFFF) == all_bits(flags) <= 0xFFFF


def test_the_table_has_a_row_for_each_register() -> None:
    assert len(as_csv().splitlines()) == len(symbols().splitlines()) == len(MAP) + 1


def test_tables_have_as_many_cells_in_each_row_and_no_value_of_32_bits_at_an_odd_address() -> None:
    assert {line.count(";") for line in as_csv().splitlines()} == {6}
    rows = [line.split(";") for line in symbols().splitlines()[1:]]
    assert {len(row) for row in rows} == {4}
    wide = [int(row[1][3:]) for row in rows if row[2] in ("UDINT", "REAL")]
    assert wide
    assert not [address for address in wide if address % 2]


def test_a_parser_nobody_here_wrote_reads_the_structured_text() -> None:
    parser = Parser(Language(tree_sitter_iec61131_3_st.language()))
    assert not parser.parse(structured_text().encode()).root_node.has_error
    assert parser.parse(structured_text().replace("END_CASE;", "", 1).encode()).root_node.has_error


def test_scl_marks_every_variable_and_nothing_else() -> None:
    statements = scl().split("BEGIN")[1]
    for variable in VARIABLES:
        assert not re.search(rf"(?<![#.\w]){variable.name}\b", statements), variable.name
    assert set(re.findall(r"(?<![\dT])#(\w+)", statements)) <= {v.name for v in VARIABLES}


def test_the_software_version_is_that_of_the_package() -> None:
    well = Health(ready=True, offline=Offline.NONE, failure=False, config_crc=7)
    version = status_window.values(State(), well, 0.0, Counts())["SW_VERSION"]
    assert isinstance(version, int)
    assert __version__.startswith(f"{version // 256}.{version % 256}.")


def test_reordered_words_come_back() -> None:
    words = list(range(STATUS_WORDS))
    swapped = reordered(STATUS_START, words)
    assert reordered(STATUS_START, swapped) == words
    assert [i for i in words if swapped[i] != i] == [7, 8, 14, 15, 16, 17, *range(62, 72)]
