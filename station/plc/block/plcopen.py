"""Prints the block as PLCopen XML (TC6), which CODESYS and TwinCAT import."""

import re
from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from station import __version__
from station.plc.block.data_types import ARRAYS, RECORDS, Array, Field
from station.plc.block.definition import NAME, VARIABLES, Variable
from station.plc.block.example import INPUTS, LOCALS, OUTPUTS, PROGRAM, statements
from station.plc.block.statements import body

NAMESPACE = "http://www.plcopen.org/xml/tc6_0200"
"""Version 2.0 of the schema, which CODESYS and TwinCAT read; 2.01 has the same elements."""
XHTML = "http://www.w3.org/1999/xhtml"
MADE = "2000-01-01T00:00:00"
"""Time in the head of the file; it is fixed, so that the same block gives the same file."""
SECTIONS = {"input": "inputVars", "output": "outputVars", "local": "localVars"}


def plcopen() -> str:
    """Return the project with data types, block and example program."""
    project = Element("project", xmlns=NAMESPACE)
    head = {"companyName": "weldgate", "productName": "weldgate registers"}
    SubElement(project, "fileHeader", {**head, "productVersion": __version__, "creationDateTime": MADE})
    content = SubElement(project, "contentHeader", name=NAME)
    info = SubElement(content, "coordinateInfo")
    for kind in ("fbd", "ld", "sfc"):
        SubElement(SubElement(info, kind), "scaling", x="1", y="1")
    types = SubElement(project, "types")
    data_types = SubElement(types, "dataTypes")
    for array in ARRAYS.values():
        _array(SubElement(SubElement(data_types, "dataType", name=array.name), "baseType"), array)
    for record, fields in RECORDS.items():
        base = SubElement(SubElement(data_types, "dataType", name=record), "baseType")
        _record(SubElement(base, "struct"), fields)
    pous = SubElement(types, "pous")
    _pou(pous, NAME, "functionBlock", variables=VARIABLES, text=body())
    _pou(pous, PROGRAM, "program", variables=(*INPUTS, *OUTPUTS, *LOCALS), text=statements())
    SubElement(SubElement(project, "instances"), "configurations")
    indent(project)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{tostring(project, encoding="unicode")}\n'


def _pou(pous: Element, name: str, kind: str, *, variables: Iterable[Variable], text: str) -> None:
    pou = SubElement(pous, "pou", name=name, pouType=kind)
    interface = SubElement(pou, "interface")
    for role, section in SECTIONS.items():
        listed = SubElement(interface, section)
        for each in variables:
            if each.role == role:
                variable = SubElement(listed, "variable", name=each.name)
                _type(SubElement(variable, "type"), each.type)
                if each.initial:
                    initial = SubElement(variable, "initialValue")
                    SubElement(initial, "simpleValue", value=each.initial)
                _documented(variable, each.meaning)
    SubElement(SubElement(SubElement(pou, "body"), "ST"), "xhtml", xmlns=XHTML).text = text


def _array(parent: Element, array: Array) -> None:
    element = SubElement(parent, "array")
    SubElement(element, "dimension", lower="0", upper=str(array.count - 1))
    _type(SubElement(element, "baseType"), array.type)


def _record(struct: Element, fields: Iterable[Field]) -> None:
    for each in fields:
        variable = SubElement(struct, "variable", name=each.name)
        _type(SubElement(variable, "type"), each.type)
        _documented(variable, each.meaning)


def _type(parent: Element, name: str) -> None:
    if re.fullmatch(r"[A-Z]+", name) and name != "TON":
        SubElement(parent, name)
    else:
        SubElement(parent, "derived", name=name)


def _documented(variable: Element, meaning: str) -> None:
    if meaning:
        SubElement(SubElement(variable, "documentation"), "xhtml", xmlns=XHTML).text = meaning
