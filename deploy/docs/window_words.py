"""Collects the words of the station that the window translates: kinds of defect, alarms, refusals, notes.

Words in enumerations and tables are read from these. Sentences that are written where they are raised or
noted are read from the source, as xgettext does: by the names of the functions and parameters they go to.
"""

import ast
import re
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import get_args, get_type_hints

from station.channel.requests import EndService, LogOut, ReloadSettings, RemoveUser, Request
from station.defects import Reason
from station.domain import Origin, Unseen, Verdict
from station.engine.rights import check
from station.errors import LoginError
from station.journal.journal import Kind
from station.journal.reviews import Opinion, State
from station.journal.users import Level
from station.plc.map.alarms import TEXTS

PARTIES = ("station", "PLC")
"""Who can cause an edge on the bus or an entry of the journal, besides people."""
ONE_FOR_EACH_LEVEL: tuple[Request, ...] = (LogOut(), EndService(), ReloadSettings(), RemoveUser(""))
"""Requests that need the levels operator, setter, quality and admin."""
SPOKEN: Mapping[str, tuple[str, ...]] = {
    "station.panel.look.purposes": ("PURPOSE_WORDS",),
    "station.panel.session.lamp": ("word", "detail", "WHY_OFFLINE", "LATE"),
    "station.panel.session.pending": ("NO_CONNECTION",),
    "station.panel.widgets.weld.recorded": ("ImageError",),
    "station.channel.requests": ("TOO_OLD", "FAULT"),
    "station.engine.logins": ("_why_ended",),
    "station.engine.operator_desk": (
        "_note",
        "_log_out",
        "_end_service",
        "append",
        "LoginError",
        "RecordError",
    ),
    "station.engine.operator_requests": ("WeldgateError",),
    "station.engine.settings_change": ("append", "SettingsError", "NOT_IN_FILE", "DIFFERENT_IN_FILE"),
    "station.engine.settings_use": ("SettingsError", "RELOAD_REFUSED"),
    "station.journal.accounts": ("LoginError", "WRONG", "WRONG_CODE", "NO_USERS", "TOO_SHORT", "reason"),
    "station.journal.pins": ("LoginError",),
    "station.journal.review_writer": ("LoginError",),
    "station.plc.bus_log": ("note", "why", "_plc_note", "_station_note"),
}
"""Names by which a module addresses people: a text given to a function, parameter or variable of this name,
or returned by a function of this name, is shown in the window."""
_WORD = re.compile(r"[A-Za-z]{2}")


def window_words() -> list[str]:
    """Return all words that the window looks up in the context "data", each once, in a stable order."""
    words = [str(word) for kind in (Verdict, Reason, Unseen, Origin, Kind, Opinion, State) for word in kind]
    words += [text for explained in TEXTS.values() for text in (explained.cause, explained.action)]
    words += [level.name.lower() for level in Level]
    words += [*PARTIES, *get_args(get_type_hints(LogOut)["why"]), *_refused_levels()]
    for name, names in SPOKEN.items():
        words += spoken(import_module(name), names)
    return list(dict.fromkeys(words))


def as_source(words: list[str]) -> str:
    """Return Python source that marks the words for Qt's lupdate; it is never run."""
    return (
        "WORDS = (\n"
        + "".join(f'    QT_TRANSLATE_NOOP("data", {_quoted(word)}),\n' for word in words)
        + ")\n"
    )


def spoken(module: ModuleType, names: tuple[str, ...]) -> list[str]:
    """Return the texts that a module says by these names. Raises LookupError for a name that says nothing."""
    tree = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
    found: list[str] = []
    for name in names:
        texts = [
            text
            for node in ast.walk(tree)
            for part in _given_to(node, name)
            for text in _texts(part, vars(module))
            if _WORD.search(text)
        ]
        if not texts:
            raise LookupError(
                f"{module.__name__}: {name!r} says nothing any more. Correct SPOKEN in {__file__}."
            )
        found += texts
    return found


def _refused_levels() -> list[str]:
    """Return what is said to somebody who is not logged in, for each level that a request can need."""
    found: list[str] = []
    for request in ONE_FOR_EACH_LEVEL:
        try:
            check(request, None)
        except LoginError as error:
            found.append(str(error))
    return found


def _given_to(node: ast.AST, name: str) -> Iterator[ast.expr]:
    """Yield the expressions that `node` gives to `name`."""
    match node:
        case ast.Call(func=ast.Name(id=called) | ast.Attribute(attr=called)) if called == name:
            yield from node.args
            yield from (keyword.value for keyword in node.keywords)
        case ast.keyword(arg=called) if called == name:
            yield node.value
        case ast.AnnAssign(target=ast.Name(id=declared), value=ast.expr() as value) if declared == name:
            yield value
        case ast.Assign(targets=targets):
            for target in targets:
                if isinstance(target, ast.Name) and target.id == name:
                    yield node.value
                elif isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                    pairs = zip(target.elts, node.value.elts, strict=True)
                    yield from (value for one, value in pairs if isinstance(one, ast.Name) and one.id == name)
        case ast.FunctionDef(name=called) if called == name:
            yield from (
                inner.value
                for inner in ast.walk(node)
                if isinstance(inner, ast.Return) and inner.value is not None
            )


def _texts(node: ast.expr, known: Mapping[str, object]) -> Iterator[str]:
    """Yield the texts that an expression can be, as far as the constants of its module tell."""
    match node:
        case ast.Constant(value=str(text)):
            yield text
        case ast.Name(id=name) if isinstance(constant := known.get(name), str):
            yield constant
        case ast.IfExp(body=body, orelse=orelse):
            yield from _texts(body, known)
            yield from _texts(orelse, known)
        case ast.Dict(values=values) | ast.Tuple(elts=values):
            for value in values:
                yield from _texts(value, known)
        case ast.JoinedStr(values=parts):
            filled = [_filled(part, known) for part in parts]
            if None not in filled:
                yield "".join(str(part) for part in filled)


def _filled(part: ast.expr, known: Mapping[str, object]) -> str | None:
    """Return a part of an f-string, or None if it is known at run time only."""
    match part:
        case ast.Constant(value=str(text)):
            return text
        case ast.FormattedValue(value=ast.Name(id=name)) if name in known:
            return str(known[name])
    return None


def _quoted(word: str) -> str:
    return '"' + word.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'
