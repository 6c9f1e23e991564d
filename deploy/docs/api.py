"""Pages of the API, one for each folder of the code, from signatures and docstrings. Nothing is imported."""

import ast
import inspect
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from deploy.docs.rooms import PACKAGES

_CODE = re.compile(r"(`[^`\n]+`)")
_SPECIAL = re.compile(r"([\\*|_`])")
_MARKUP = re.compile(r"^([-+*:.>]|\d+[.)]|\w[.)]\s)")


@dataclass(frozen=True, slots=True)
class Entry:
    """One thing of the API: its directive, its signature, options and documentation, and what it holds."""

    directive: str
    signature: str
    options: tuple[str, ...]
    text: str
    inner: tuple["Entry", ...] = ()


def write_pages(root: Path, folder: Path) -> int:
    """Write one page for each folder of code, and an index. Return their number."""
    folder.mkdir(parents=True, exist_ok=True)
    names: list[str] = []
    for package in PACKAGES:
        for init in sorted((root / package).rglob("__init__.py"), key=lambda path: path.as_posix()):
            name = ".".join(init.parent.relative_to(root).parts)
            (folder / f"{name}.rst").write_text(page(root, init.parent), encoding="utf-8")
            names.append(name)
    (folder / "index.rst").write_text(INDEX + "".join(f"   {name}\n" for name in names), encoding="utf-8")
    return len(names) + 1


INDEX = """API
===

All public names, folder by folder, as the code documents them.

.. toctree::
   :maxdepth: 1

"""


def page(root: Path, folder: Path) -> str:
    """Return the page of one folder: its own docstring, then module by module."""
    name = ".".join(folder.relative_to(root).parts)
    lines = [name, "=" * len(name), ""]
    files = sorted(folder.glob("*.py"), key=lambda path: (path.stem != "__init__", path.stem))
    for path in files:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        module = name if path.stem == "__init__" else f"{name}.{path.stem}"
        if path.stem != "__init__":
            title = f"{path.stem}".replace("_", r"\_")
            lines += [title, "-" * len(title), ""]
        lines += [f".. py:module:: {module}", "", *_text(ast.get_docstring(tree) or ""), ""]
        tree = _Qualified(tree, module).visit(tree)
        for entry in entries(tree.body):
            lines += _written(entry, "")
    return "\n".join(lines) + "\n"


class _Qualified(ast.NodeTransformer):
    """Writes the names in annotations in full, so that each leads to the right one of its name."""

    def __init__(self, tree: ast.Module, module: str) -> None:
        self._full: dict[str, str] = {}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module:
                self._full |= {
                    alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names
                }
        for node in tree.body:
            if isinstance(node, ast.ClassDef):
                self._full[node.name] = f"{module}.{node.name}"
            elif isinstance(node, ast.Assign):
                self._full |= {to.id: f"{module}.{to.id}" for to in node.targets if isinstance(to, ast.Name)}

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AnnAssign:
        """Rewrite the annotation of a field or constant."""
        node.annotation = self._written(node.annotation)
        return node

    def visit_arg(self, node: ast.arg) -> ast.arg:
        """Rewrite the annotation of an argument."""
        node.annotation = None if node.annotation is None else self._written(node.annotation)
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        """Rewrite the annotation of a result, and those of the arguments."""
        node.returns = None if node.returns is None else self._written(node.returns)
        return self.generic_visit(node)

    def _written(self, annotation: ast.expr) -> ast.expr:
        if isinstance(annotation, ast.Constant) and isinstance(annotation.value, str):
            annotation = ast.parse(annotation.value, mode="eval").body
        full = self._full

        class Names(ast.NodeTransformer):
            def visit_Name(self, node: ast.Name) -> ast.expr:
                return ast.parse(f"~{full[node.id]}", mode="eval").body if node.id in full else node

            def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
                if isinstance(node.value, ast.Name) and node.value.id in ("Literal", "Annotated"):
                    return node
                return ast.copy_location(
                    ast.Subscript(self.visit(node.value), self.visit(node.slice), node.ctx), node
                )

        written: ast.expr = Names().visit(annotation)
        return written


def entries(body: Sequence[ast.stmt], in_class: bool = False) -> Iterator[Entry]:
    """Yield what a module or a class makes public, in the order of the source; of each name the first."""
    seen: set[str] = set()
    for number, node in enumerate(body):
        after = body[number + 1] if number + 1 < len(body) else None
        for entry in _entry(node, after, in_class):
            name = entry.signature.split("(")[0]
            if not name.startswith("_") and name not in seen:
                seen.add(name)
                yield entry


def _entry(node: ast.stmt, after: ast.stmt | None, in_class: bool) -> Iterator[Entry]:
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        yield _function(node, in_class)
    elif isinstance(node, ast.ClassDef):
        yield _class(node)
    elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        options = (f":type: {ast.unparse(node.annotation)}", *_value(node.value))
        yield Entry("attribute" if in_class else "data", node.target.id, options, _following(after))
    elif isinstance(node, ast.Assign):
        text = _following(after)
        for target in node.targets:
            if isinstance(target, ast.Name) and (text or in_class):
                yield Entry("attribute" if in_class else "data", target.id, _value(node.value), text)


def _class(node: ast.ClassDef) -> Entry:
    """Return a class with the arguments of its constructor, or with its bases if it has none of its own."""
    made = next(
        (one for one in node.body if isinstance(one, ast.FunctionDef) and one.name == "__init__"), None
    )
    text = ast.get_docstring(node) or ""
    given = ", ".join(ast.unparse(base) for base in node.bases)
    if made is not None:
        given = (
            _function(made, in_class=True).signature.removeprefix("__init__(").removesuffix(" -> None")[:-1]
        )
        text += "\n\n" + (ast.get_docstring(made) or "")
    inner = tuple(entries(node.body, in_class=True))
    return Entry("class", f"{node.name}({given})" if given else node.name, (), text.strip(), inner)


def _function(node: ast.FunctionDef | ast.AsyncFunctionDef, in_class: bool) -> Entry:
    marks = {ast.unparse(mark).split(".")[-1] for mark in node.decorator_list}
    text = ast.get_docstring(node) or ""
    returns = ast.unparse(node.returns) if node.returns else ""
    if in_class and marks & {"property", "cached_property"}:
        return Entry("property", node.name, (f":type: {returns}",) if returns else (), text)
    arguments = node.args
    if in_class and "staticmethod" not in marks:
        arguments = ast.arguments(**{**dict(ast.iter_fields(arguments)), "args": arguments.args[1:]})
    options = tuple(f":{mark}:" for mark in ("staticmethod", "classmethod") if mark in marks)
    options += (":async:",) if isinstance(node, ast.AsyncFunctionDef) else ()
    signature = f"{node.name}({ast.unparse(arguments)})" + (f" -> {returns}" if returns else "")
    return Entry("method" if in_class else "function", signature, options, text)


def _value(value: ast.expr | None) -> tuple[str, ...]:
    """Return the value as it is shown, if it is short."""
    text = "" if value is None else ast.unparse(value)
    return (f":value: {text}",) if text and len(text) <= 60 and "\n" not in text else ()


def _following(node: ast.stmt | None) -> str:
    """Return the docstring that follows a constant or a field."""
    if (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    ):
        return inspect.cleandoc(node.value.value)
    return ""


def _written(entry: Entry, margin: str) -> list[str]:
    inside = margin + "   "
    lines = [
        f"{margin}.. py:{entry.directive}:: {entry.signature}",
        *(inside + option for option in entry.options),
        "",
    ]
    lines += [inside + line if line else "" for line in _text(entry.text)]
    lines.append("")
    for inner in entry.inner:
        lines += _written(inner, inside)
    return lines


def _text(docstring: str) -> list[str]:
    """Return a docstring as reStructuredText: paragraphs as they are meant, indented blocks as they stand."""
    lines: list[str] = []
    for block in re.split(r"\n\s*\n", docstring):
        rows = block.splitlines()
        if rows and all(row.startswith("    ") for row in rows):
            lines += ["::", "", *rows, ""]
        elif rows:
            lines += [_escaped(" ".join(row.strip() for row in rows)), ""]
    return lines


def _escaped(text: str) -> str:
    """Return text in which nothing but code in backticks is marked up."""
    parts = [part if _CODE.fullmatch(part) else _SPECIAL.sub(r"\\\1", part) for part in _CODE.split(text)]
    text = "".join(f"\\ {part}\\ " if _CODE.fullmatch(part) else part for part in parts).strip()
    return f"\\ {text}" if _MARKUP.match(text) else text
