"""What the documentation says, taken apart: headings, blocks of code, commands."""

import argparse
import io
import re
import shlex
from collections.abc import Callable, Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from unittest.mock import patch

from deploy.demo.run import main as demo
from deploy.docs.sources import pages
from models.__main__ import main as models
from station.__main__ import main as station
from synth.__main__ import main as synth
from tests.conftest import ROOT

PAGES = sorted(pages(ROOT))
COMMANDS: dict[str, Callable[[Sequence[str] | None], int]] = {
    "weldgate": station,
    "weldgate-demo": demo,
    "weldgate-models": models,
    "weldgate-synth": synth,
}
_HEADING = re.compile(r"^#{1,6} +(.+?) *$", re.MULTILINE)
_FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
_CODE = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")


@dataclass(frozen=True, slots=True)
class Block:
    """One fenced block of code."""

    language: str
    text: str


@cache
def text_of(page: str) -> str:
    """Return the text of a page."""
    return (ROOT / page).read_text(encoding="utf-8")


def headings(page: str) -> list[str]:
    """Return the headings of a page, without what stands in blocks of code."""
    return _HEADING.findall(_FENCE.sub("", text_of(page)))


def anchors(page: str) -> set[str]:
    """Return the anchors of a page's headings, as Markdown viewers make them."""
    plain = [re.sub(r"[`*]|\\(?=\W)", "", heading).lower() for heading in headings(page)]
    return {re.sub(r"[^\w\- ]", "", heading).replace(" ", "-") for heading in plain}


def blocks(page: str, *languages: str) -> list[Block]:
    """Return the blocks of code of a page in some languages."""
    return [Block(*found) for found in _FENCE.findall(text_of(page)) if found[0] in languages]


def code_spans(page: str) -> list[str]:
    """Return what stands between single backticks on a page."""
    return _CODE.findall(_FENCE.sub("", text_of(page)))


def commands(page: str) -> Iterator[list[str]]:
    """Yield the words of each command line in the shell blocks of a page."""
    for block in blocks(page, "bash"):
        for line in block.text.splitlines():
            if line.strip() and not line.startswith("#"):
                yield shlex.split(line)


@cache
def make_targets() -> frozenset[str]:
    """Return the targets of the Makefile."""
    return frozenset(
        re.findall(r"^([a-z][a-z-]*):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    )


class _Parsed(Exception):
    """A command line was understood."""


def refusal(name: str, arguments: Sequence[str]) -> str:
    """Return why a command refuses its arguments, or nothing. Nothing is run."""
    parse = argparse.ArgumentParser.parse_args

    def only_parse(parser: argparse.ArgumentParser, *given: object) -> argparse.Namespace:
        parse(parser, *given)  # type: ignore[call-overload]
        raise _Parsed

    said = io.StringIO()
    with patch.object(argparse.ArgumentParser, "parse_args", only_parse), redirect_stderr(said):
        try:
            COMMANDS[name](arguments)
        except _Parsed:
            return ""
        except SystemExit:
            return said.getvalue()
    raise AssertionError(f"{name} did not parse its arguments")


@cache
def help_of(name: str, *subcommands: str) -> str:
    """Return the help of a command, or nothing if there is no such command."""
    said = io.StringIO()
    with redirect_stdout(said), redirect_stderr(io.StringIO()):
        try:
            COMMANDS[name]([*subcommands, "--help"])
        except SystemExit as end:
            return "" if end.code else said.getvalue()
    raise AssertionError(f"{name} has no help")


def existing(path: str) -> bool:
    """Return whether a path exists in the repository."""
    return Path(ROOT, path).exists()
