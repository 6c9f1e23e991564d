"""Looks for what a browser would load from a network when it shows the built site."""

import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

_REMOTE = re.compile(r"^\s*(https?:)?//", re.IGNORECASE)
_STYLE = re.compile(r"(?:url\(|@import)\s*[\"']?((?:https?:)?//[^\s\"')]+)", re.IGNORECASE)
_SCRIPT = re.compile(
    r"(?:\bimport\s*\(?|\bfetch\(|\.src\s*=|importScripts\()\s*[\"'`]((?:https?:)?//[^\"'`]+)"
)
_NOT_LOADED = {"canonical", "next", "prev", "author", "license", "search", "index", "help", "alternate"}
"""Relations of a link element that name a page and load nothing."""


class _Loaded(HTMLParser):
    """Collects the addresses that an element loads when it is shown."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Look at one element."""
        named = {name: value or "" for name, value in attrs}
        addresses = [named.get(name, "") for name in ("src", "srcset", "poster", "data")]
        if tag == "link" and not set(named.get("rel", "").split()) <= _NOT_LOADED:
            addresses.append(named.get("href", ""))
        if tag in ("use", "image"):
            addresses += [named.get("href", ""), named.get("xlink:href", "")]
        self.found += [address for address in addresses if _REMOTE.match(address)]
        self.found += _STYLE.findall(named.get("style", ""))


def loaded_from_network(site: Path) -> Iterator[str]:
    """Yield one line for each address that a page, style sheet or script would load from elsewhere."""
    for path in sorted(site.rglob("*")):
        if path.suffix not in (".html", ".css", ".js", ".svg"):
            continue
        text = path.read_text(encoding="utf-8")
        found: list[str] = []
        if path.suffix in (".html", ".svg"):
            parser = _Loaded()
            parser.feed(text)
            found += parser.found
        found += _STYLE.findall(text)
        found += _SCRIPT.findall(text) if path.suffix in (".html", ".js") else []
        for address in found:
            yield f"{path.relative_to(site)} loads {address}"
