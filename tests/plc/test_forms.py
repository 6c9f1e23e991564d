"""The forms of the block for tools: PLCopen XML, OpenPLC, and the page of inputs and outputs."""

import random
import re
from types import SimpleNamespace
from xml.etree import ElementTree

import tree_sitter_iec61131_3_st
from tree_sitter import Language, Parser

from station.plc.block.advice import ADVICE
from station.plc.block.data_types import ARRAYS, RECORDS
from station.plc.block.definition import NAME, REFUSALS, VARIABLES
from station.plc.block.document import block_page
from station.plc.block.example import INPUTS, LOCALS, OUTPUTS, PROGRAM, statements
from station.plc.block.openplc import openplc
from station.plc.block.plcopen import NAMESPACE, XHTML, plcopen
from station.plc.block.statements import body
from station.plc.block.transcribe import Block, compiled
from station.plc.map.registers import COMMAND_WORDS, STATUS_START, STATUS_WORDS
from station.settings.plc import PRESETS
from tests.plc.test_controllers import Station

IN = {"": NAMESPACE, "x": XHTML}
RESERVED = frozenset(
    "ACTION ARRAY AT BY CASE CONFIGURATION CONSTANT DO ELSE ELSIF EN ENO END_STEP EXIT FINAL FOR FROM "
    "FUNCTION IF INITIAL_STEP INTERVAL LIMIT MAX MIN MOD MUX N NOT OF ON OR P PRIORITY PROGRAM R READ_ONLY "
    "REPEAT RESOURCE RETAIN RETURN S SEL SINGLE STEP STRUCT TASK THEN TO TON TRANSITION TYPE UNTIL VAR WHILE "
    "WITH XOR".split()
)
"""Words that no name may be, in whatever case: matiec refuses a variable named Step."""
OPENPLC_BASE = 1024
"""Holding register of %MW0 in OpenPLC's Modbus server."""


def test_plcopen_holds_every_type_variable_and_statement() -> None:
    project = ElementTree.fromstring(plcopen())
    assert project.tag == f"{{{NAMESPACE}}}project"
    types = [each.get("name") for each in project.iterfind(".//dataType", IN)]
    assert types == [*ARRAYS, *RECORDS]
    block, program = project.findall(".//pou", IN)
    assert (block.get("name"), block.get("pouType")) == (NAME, "functionBlock")
    assert (program.get("name"), program.get("pouType")) == (PROGRAM, "program")
    for role, section in (("input", "inputVars"), ("output", "outputVars"), ("local", "localVars")):
        names = [each.get("name") for each in block.iterfind(f"interface/{section}/variable", IN)]
        assert names == [each.name for each in VARIABLES if each.role == role]
    texts = [each.findtext("body/ST/x:xhtml", namespaces=IN) for each in (block, program)]
    assert texts == [body(), statements()]
    derived = {each.get("name") for each in project.iterfind(".//derived", IN)}
    assert derived == {*ARRAYS, *RECORDS, NAME, "TON"}, "each named type is defined, or standard"


def test_openplc_ties_every_word_of_both_windows_to_the_memory_that_its_preset_names() -> None:
    text = openplc()
    located = {int(address): name for name, address in re.findall(r"(\w+) AT %MW(\d+) : WORD;", text)}
    assert sorted(located) == [*range(COMMAND_WORDS), *range(STATUS_START, STATUS_START + STATUS_WORDS)]
    for address, name in located.items():
        moved = f"{name} := Command[{address}];"
        assert (moved if address < COMMAND_WORDS else f"Window[{address - STATUS_START}] := {name};") in text
    preset = PRESETS["openplc"]
    assert (preset["command_base"], preset["status_base"]) == (OPENPLC_BASE, OPENPLC_BASE + STATUS_START)
    parser = Parser(Language(tree_sitter_iec61131_3_st.language()))
    assert not parser.parse(text.encode()).root_node.has_error


def test_no_name_is_a_word_of_the_language() -> None:
    variables = (*VARIABLES, *INPUTS, *OUTPUTS, *LOCALS)
    fields = [field.name for record in RECORDS.values() for field in record]
    names = [*(each.name for each in variables), *fields, *RECORDS, *ARRAYS]
    names = [name.upper() for name in names]
    assert not RESERVED.intersection(names)


def test_the_page_explains_every_input_output_refusal_and_field() -> None:
    page = block_page()
    for each in VARIABLES:
        if each.role != "local":
            assert f"| {each.name} | " in page
            assert each.meaning
    for code, name in enumerate(REFUSALS):
        assert not code or f"| {code} | {name} | {ADVICE[code]} |" in page
    for fields in RECORDS.values():
        assert all(f"| {each.name} | " in page and each.meaning for each in fields)


class Called:
    """The block as its instance in a program: a call with named inputs, outputs as members."""

    def __init__(self) -> None:
        self._block = Block()

    def __call__(self, now_s: float, **inputs: object) -> None:
        vars(self._block.v).update(inputs)
        self._block.cycle(now_s)

    def __getattr__(self, name: str) -> object:
        return getattr(self._block.v, name)


def test_the_example_lets_out_good_parts_alone() -> None:
    """Parts come and go at random; a person takes out the bad ones."""
    rng, now_s, code = random.Random(5), 0.0, compiled(statements())
    station, called = Station(random.Random(6)), Called()
    initial = {each.name: 0 for each in (*INPUTS, *OUTPUTS)}
    v = SimpleNamespace(
        **initial, Window=[0] * STATUS_WORDS, Serial=[0] * 16, Fresh=True, Stage=0, Start=False
    )
    v.Released, v.Demonstration, v.Station, v.Command = 77, False, called, [0] * COMMAND_WORDS
    good, bad = 0, 0
    for _ in range(20_000):
        now_s += 0.01
        station.cycle(now_s, v.Command)
        v.Window = list(station.words)
        if v.Stage == 0:
            v.PartThere, v.Reset, v.Serial = rng.random() < 0.3, False, [rng.randrange(0x10000)] * 16
        elif v.Stage == 30 or (v.Stage == 40 and rng.random() < 0.1):
            v.PartThere, v.Reset = False, v.Stage == 40
        before = v.Stage
        exec(code, {"v": v, "now_s": now_s})
        if before == 20 and v.Stage == 30:
            assert station.truth[called.TriggerId] == (True, v.Serial)
            good += 1
        bad += before == 20 and v.Stage == 40
        assert v.GoodOut == (v.Stage == 30)
    assert good > 100
    assert bad > 30
