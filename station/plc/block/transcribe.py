"""Translates the block's Structured Text to Python, so that the simulated line runs what PLCs run.

Covers what `statements` uses: assignments, IF, CASE, FOR, calls of TON, and expressions by the precedence of
IEC 61131-3 table 71. A division is one of whole numbers.
"""

import re
from collections.abc import Iterator
from types import CodeType, SimpleNamespace
from typing import Any

from station.plc.block.data_types import ARRAYS, RECORDS
from station.plc.block.definition import VARIABLES
from station.plc.block.statements import body
from station.plc.block.timers import Clock, TimerKind, timer

TOKEN = re.compile(
    r"\(\*.*?\*\)|:=|<>|<=|>=|\.\.|T#\w+|16#[0-9A-F]+|[A-Za-z_]\w*|\d+\.\d+|\d+|[-+*/()\[\];,.:=<>]",
    re.S,
)
"""Pattern of a comment or of one token."""
LEVELS: tuple[dict[str, str], ...] = (
    {"OR": "|"},
    {"AND": "&"},
    {"=": "==", "<>": "!="},
    {"<": "<", ">": ">", "<=": "<=", ">=": ">="},
    {"+": "+", "-": "-"},
    {"*": "*", "/": "//", "MOD": "%"},
)
"""Operators with Python's equivalent, the weakest first; every operation is put in brackets."""
UNITS = {"ms": 0.001, "s": 1.0}
"""Units of a time in seconds."""
MASKS = {"WORD": 0xFFFF, "UINT": 0xFFFF, "INT": 0x7FFF, "UDINT": 0xFFFFFFFF}
"""Bits that a conversion keeps, by its target; no INT of the block is negative."""


def tokens(text: str) -> list[str]:
    """Return the tokens of a text without its comments. Raises ValueError for anything else."""
    rest = TOKEN.sub("", text).strip()
    if rest:
        raise ValueError(f"not Structured Text: {rest[:20]!r}")
    return [token for token in TOKEN.findall(text) if not token.startswith("(*")]


class _Writer:
    """Translator from tokens to lines of Python."""

    def __init__(self, text: str) -> None:
        self._tokens = tokens(text)
        self._at = 0
        self.lines: list[str] = []

    def program(self) -> str:
        """Return all statements as Python."""
        self._statements(0, ())
        return "\n".join(self.lines)

    def _peek(self, ahead: int = 0) -> str:
        return self._tokens[self._at + ahead] if self._at + ahead < len(self._tokens) else ""

    def _take(self, *expected: str) -> str:
        token = self._peek()
        if expected and token not in expected:
            near = " ".join(self._tokens[self._at - 5 : self._at + 5])
            raise ValueError(f"{token!r} instead of {' or '.join(expected)}, near {near}")
        self._at += 1
        return token

    def _put(self, depth: int, line: str) -> None:
        self.lines.append("    " * depth + line)

    def _statements(self, depth: int, ends: tuple[str, ...]) -> None:
        before = len(self.lines)
        while (
            self._peek()
            and self._peek() not in ends
            and not (self._peek().isdigit() and self._peek(1) == ":")
        ):
            self._statement(depth)
        if len(self.lines) == before:
            self._put(depth, "pass")

    def _statement(self, depth: int) -> None:
        first = self._peek()
        if first == "IF":
            self._if(depth)
        elif first == "CASE":
            self._case(depth)
        elif first == "FOR":
            self._for(depth)
        elif self._peek(1) == "(":
            self._call(depth)
        else:
            target = self._place()
            self._take(":=")
            self._put(depth, f"{target} = {self._expression()}")
        self._take(";")

    def _if(self, depth: int) -> None:
        word = "if"
        while self._peek() in ("IF", "ELSIF"):
            self._take()
            self._put(depth, f"{word} {self._expression()}:")
            self._take("THEN")
            self._statements(depth + 1, ("ELSIF", "ELSE", "END_IF"))
            word = "elif"
        if self._peek() == "ELSE":
            self._take()
            self._put(depth, "else:")
            self._statements(depth + 1, ("END_IF",))
        self._take("END_IF")

    def _case(self, depth: int) -> None:
        self._take("CASE")
        self._put(depth, f"match {self._expression()}:")
        self._take("OF")
        while self._peek() != "END_CASE":
            self._put(depth + 1, f"case {self._take()}:")
            self._take(":")
            self._statements(depth + 2, ("END_CASE",))
        self._take("END_CASE")

    def _for(self, depth: int) -> None:
        self._take("FOR")
        name = self._place()
        self._take(":=")
        first = self._expression()
        self._take("TO")
        last = self._expression()
        self._take("DO")
        self._put(depth, f"for {name} in range({first}, {last} + 1):")
        self._statements(depth + 1, ("END_FOR",))
        self._take("END_FOR")

    def _call(self, depth: int) -> None:
        block = self._take()
        self._take("(")
        given = []
        while self._peek() != ")":
            name = self._take()
            self._take(":=")
            given.append(f"{name}={self._expression()}")
            if self._peek() == ",":
                self._take()
        self._take(")")
        self._put(depth, f"v.{block}(now_s, {', '.join(given)})")

    def _place(self) -> str:
        place = "v." + self._take()
        while self._peek() in (".", "["):
            if self._take() == ".":
                place += "." + self._take()
            else:
                place += f"[{self._expression()}]"
                self._take("]")
        return place

    def _expression(self, level: int = 0) -> str:
        if level == len(LEVELS):
            return self._unary()
        left = self._expression(level + 1)
        while self._peek() in LEVELS[level]:
            sign = LEVELS[level][self._take()]
            left = f"({left} {sign} {self._expression(level + 1)})"
        return left

    def _unary(self) -> str:
        token = self._peek()
        if token == "NOT":
            self._take()
            return f"(not {self._unary()})"
        if token == "(":
            self._take()
            inner = self._expression()
            self._take(")")
            return inner
        if token.startswith("16#"):
            return str(int(self._take()[3:], 16))
        if token.startswith("T#"):
            return repr(_seconds(self._take()))
        if token[0].isdigit():
            return self._take()
        if token in ("TRUE", "FALSE"):
            return self._take().capitalize()
        if "_TO_" in token and self._peek(1) == "(":
            self._take()
            target = token.split("_TO_")[1]
            self._take("(")
            inner = self._expression()
            self._take(")")
            return f"float({inner})" if target == "REAL" else f"({inner} & {MASKS[target]})"
        return self._place()


def compiled(text: str) -> CodeType:
    """Return statements, as those of the block's body, as code over `v` (the variables) and `now_s`."""
    return compile(_Writer(text).program(), "WeldgateStation", "exec")


def _seconds(time: str) -> float:
    """Return a time such as T#500ms in seconds."""
    amount, unit = re.fullmatch(r"T#(\d+)(ms|s)", time).groups()  # type: ignore[union-attr]
    return int(amount) * UNITS[unit]


def _initial(kind: str, initial: str) -> Any:
    if kind in ARRAYS:
        return [_initial(ARRAYS[kind].type, "")] * ARRAYS[kind].count
    if kind in RECORDS:
        return SimpleNamespace(**{each.name: _initial(each.type, "") for each in RECORDS[kind]})
    if kind == "TIME":
        return _seconds(initial or "T#0s")
    if kind == "REAL":
        return 0.0
    return initial == "TRUE" if kind == "BOOL" else int(initial or 0)


class Block:
    """Instance of the function block; its variables are attributes of `v`."""

    _code: CodeType | None = None

    def __init__(self, timers: TimerKind = TimerKind.CALL) -> None:
        if Block._code is None:
            Block._code = compiled(body())
        self._clock = Clock()
        self.v = SimpleNamespace(**dict(_variables(timers, self._clock)))

    def cycle(self, now_s: float) -> None:
        """Run one cycle of the PLC at a monotonic time."""
        self._clock.now_s = max(self._clock.now_s, now_s)
        if Block._code is not None:
            exec(Block._code, {"v": self.v, "now_s": now_s})


def _variables(timers: TimerKind, clock: Clock) -> Iterator[tuple[str, Any]]:
    for variable in VARIABLES:
        is_timer = variable.type == "TON"
        yield variable.name, timer(timers, clock) if is_timer else _initial(variable.type, variable.initial)
