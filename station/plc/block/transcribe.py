"""Translates the block's Structured Text to Python, so that the simulated line runs what PLCs run.

Covers what `definition` uses: assignments, IF, CASE, FOR, calls of TON and R_TRIG, and expressions by the
precedence of IEC 61131-3 table 71.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from types import CodeType, SimpleNamespace
from typing import Any

from station.plc.block.definition import RECORD, VARIABLES, body, fields

TOKEN = re.compile(
    r"\(\*.*?\*\)|:=|<>|<=|>=|\.\.|T#\w+|16#[0-9A-F]+|[A-Za-z_]\w*|\d+|[-+*()\[\];,.:=<>]", re.S
)
"""Pattern of a comment or of one token."""
LEVELS: tuple[dict[str, str], ...] = (
    {"OR": "|"},
    {"AND": "&"},
    {"=": "==", "<>": "!="},
    {"<": "<", ">": ">", "<=": "<=", ">=": ">="},
    {"+": "+", "-": "-"},
    {"*": "*", "MOD": "%"},
)
"""Operators with Python's equivalent, the weakest first; every operation is put in brackets."""
UNITS = {"ms": 0.001, "s": 1.0}
"""Units of a time in seconds."""


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
            amount, unit = re.fullmatch(r"T#(\d+)(ms|s)", self._take()).groups()  # type: ignore[union-attr]
            return repr(int(amount) * UNITS[unit])
        if token.isdigit():
            return self._take()
        if token in ("TRUE", "FALSE"):
            return self._take().capitalize()
        if "_TO_" in token and self._peek(1) == "(":
            self._take()
            bits = {"WORD": 0xFFFF, "UINT": 0xFFFF, "UDINT": 0xFFFFFFFF}[token.split("_TO_")[1]]
            self._take("(")
            inner = self._expression()
            self._take(")")
            return f"({inner} & {bits})"
        return self._place()


@dataclass
class _Ton:
    """On-delay timer of IEC 61131-3, table 46: Q is TRUE once IN has been TRUE for PT."""

    Q: bool = False
    since_s: float | None = None

    def __call__(self, now_s: float, IN: bool, PT: float) -> None:  # noqa: N803 - the standard's names
        if not IN:
            self.since_s, self.Q = None, False
        else:
            self.since_s = now_s if self.since_s is None else self.since_s
            self.Q = now_s - self.since_s >= PT


@dataclass
class _Edge:
    """Rising-edge trigger of IEC 61131-3, table 44: Q is TRUE for one call after CLK rose."""

    Q: bool = False
    before: bool = field(default=False)

    def __call__(self, _now_s: float, CLK: bool) -> None:  # noqa: N803 - the standard's names
        self.Q, self.before = CLK and not self.before, CLK


def compiled() -> CodeType:
    """Return the block's body as code over `v` (the variables) and `now_s`."""
    return compile(_Writer(body()).program(), "WeldgateStation", "exec")


def _initial(kind: str, initial: str) -> Any:
    array = re.fullmatch(r"ARRAY\[0\.\.(\d+)\] OF (\w+)", kind)
    if array:
        return [_initial(array[2], "")] * (int(array[1]) + 1)
    if kind in ("TON", "R_TRIG"):
        return _Ton() if kind == "TON" else _Edge()
    if kind == RECORD:
        return SimpleNamespace(**{name: _initial(of, "") for name, of, _ in fields()})
    if kind == "TIME":
        return float(initial.removeprefix("T#").removesuffix("s"))
    return {"BOOL": False}.get(kind, int(initial or 0))


class Block:
    """Instance of the function block; its variables are attributes of `v`."""

    _code: CodeType | None = None

    def __init__(self) -> None:
        if Block._code is None:
            Block._code = compiled()
        self.v = SimpleNamespace(**dict(_variables()))

    def cycle(self, now_s: float) -> None:
        """Run one cycle of the PLC at a monotonic time."""
        if Block._code is not None:
            exec(Block._code, {"v": self.v, "now_s": now_s})


def _variables() -> Iterator[tuple[str, Any]]:
    for variable in VARIABLES:
        yield variable.name, _initial(variable.type, variable.initial)
