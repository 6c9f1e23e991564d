"""Pages of the site: from which files they come, in which order they are read, how their links are turned.

In the repository a page links to other files as any Markdown does. In the site a link to a page leads to the
page, a link to a Python file to its entry in the API, a link to any other file to a copy of it; drawings
become part of the page, so that they follow its colours.
"""

import os
import re
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from deploy.docs.rooms import PACKAGES

HERE = PurePosixPath("deploy/docs")
ELSEWHERE = {
    "deploy/plc/README.md": "plc/index.md",
    "deploy/plc/block.md": "plc/block.md",
    "deploy/plc/register_map.md": "plc/register-map.md",
    "deploy/records.md": "records.md",
    "models/shipped/CARD.md": "networks/classifier.md",
    "models/shipped/RING.md": "networks/ring.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
}
"""Pages that lie elsewhere in the repository, because tools or people look for them there."""
NAVIGATION = (
    ("Begin", ("tutorial", "install", "window", "commands", "glossary")),
    ("Integrate", ("plc/index", "integrator", "plc/block", "plc/register-map", "troubleshooting", "records")),
    ("Understand", ("architecture", "rooms", "decisions/index", "networks/classifier", "networks/ring")),
    ("Change", ("how-to/index", "contributing", "api/index", "changelog")),
)
"""Groups of the navigation and the pages in them."""
_LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+)\)")
_FENCE = re.compile(r"^\s*(```|~~~)")


class LinkError(Exception):
    """A link that leads nowhere."""


@dataclass(frozen=True, slots=True)
class Link:
    """One link or picture in a page."""

    line: int
    is_picture: bool
    text: str
    target: str


def pages(root: Path) -> dict[str, str]:
    """Return the pages that are written by hand: path in the repository, path in the site."""
    own = {
        path.relative_to(root).as_posix(): path.relative_to(root / HERE).as_posix()
        for path in sorted((root / HERE).rglob("*.md"))
    }
    return own | {source: target for source, target in ELSEWHERE.items() if (root / source).exists()}


def links(text: str) -> Iterator[Link]:
    """Yield all links and pictures of a page, except in blocks of code."""
    for number, line in _prose(text):
        for found in _LINK.finditer(line):
            yield Link(number, bool(found[1]), found[2], found[3])


def _prose(text: str) -> Iterator[tuple[int, str]]:
    """Yield number and text of the lines outside of blocks of code."""
    fenced = False
    for number, line in enumerate(text.splitlines(), start=1):
        if _FENCE.match(line):
            fenced = not fenced
        elif not fenced:
            yield number, line


def target_of(source: str, target: str) -> tuple[str, str]:
    """Return the path in the repository to which a link leads, and its anchor."""
    path, _, anchor = target.partition("#")
    if not path:
        return source, anchor
    return os.path.normpath(PurePosixPath(source).parent / path).replace(os.sep, "/"), anchor


def stage(root: Path, folder: Path) -> int:
    """Write all pages into a folder as Sphinx takes them, with the files that they show. Return their number.

    Raises LinkError naming page, line and link.
    """
    known = pages(root)
    for source, target in known.items():
        text = (root / source).read_text(encoding="utf-8")
        prose = dict(_prose(text))
        lines = [
            _turned(root, folder, known, source, number, line) if number in prose else line
            for number, line in enumerate(text.splitlines(), start=1)
        ]
        _write(folder / target, "\n".join(lines) + "\n" + _contents(target, known))
    return len(known)


def _turned(root: Path, folder: Path, known: Mapping[str, str], source: str, number: int, line: str) -> str:
    def turned(found: re.Match[str]) -> str:
        target = found[3]
        if "://" in target or target.startswith(("#", "mailto:")):
            return found[0]
        path, anchor = target_of(source, target)
        if not (root / path).exists():
            raise LinkError(f"{source}:{number}: {target} does not exist. Correct the link.")
        return _written(root, folder, known, (source, path, anchor), found)

    return _LINK.sub(turned, line)


def _written(
    root: Path, folder: Path, known: Mapping[str, str], way: tuple[str, str, str], found: re.Match[str]
) -> str:
    """Return a link as it is written in the site."""
    source, path, anchor = way
    text = found[2].replace("`", "")
    if path in known or f"{path}/README.md" in known:
        to = known.get(path) or known[f"{path}/README.md"]
        up = os.path.relpath(to, PurePosixPath(known[source]).parent).replace(os.sep, "/")
        return f"[{found[2]}]({up}{'#' + anchor if anchor else ''})"
    if path.split("/")[0] in PACKAGES and (path.endswith(".py") or (root / path / "__init__.py").exists()):
        module = path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
        return f"{{py:mod}}`{text} <{module}>`"
    if (root / path).is_dir():
        return found[2]
    copy = folder / "files" / path
    copy.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(root / path, copy)
    if found[1] and path.endswith(".svg"):
        copy.write_text(
            f'<div class="drawing">{(root / path).read_text(encoding="utf-8")}</div>', encoding="utf-8"
        )
        return f"```{{raw}} html\n:file: {copy.resolve()}\n```"
    if found[1]:
        return f"![{found[2]}](/files/{path})"
    return f"{{download}}`{text} </files/{path}>`"


def _contents(target: str, known: Mapping[str, str]) -> str:
    """Return the table of contents that a page carries: the whole navigation, or the pages of its folder."""
    if target == "index.md":
        return "".join(_tree(names, caption) for caption, names in NAVIGATION)
    if target in ("how-to/index.md", "decisions/index.md"):
        folder = target.split("/")[0]
        own = sorted(to for to in known.values() if to.startswith(f"{folder}/") and to != target)
        return _tree([name.removeprefix(f"{folder}/").removesuffix(".md") for name in own], "")
    return ""


def _tree(names: "list[str] | tuple[str, ...]", caption: str) -> str:
    head = f":caption: {caption}\n" if caption else ""
    return f"\n```{{toctree}}\n:hidden:\n{head}\n" + "\n".join(names) + "\n```\n"


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
