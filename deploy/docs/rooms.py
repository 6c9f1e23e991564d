"""Rooms of the code and the imports between them: found with grimp, compared with the layer contracts.

A room is a folder below one of the packages, or a loose file. The loose files of a package that import no
room of it are its ground and count as one room.
"""

import ast
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import grimp

PACKAGES = ("station", "synth", "models", "deploy")
"""Top-level packages, in the order in which they are described."""
MOST_ROOMS = 25
"""More rooms than this in one drawing cannot be taken in."""


@dataclass(frozen=True, slots=True, order=True)
class Import:
    """One import, by the names of the two modules."""

    importer: str
    imported: str


@dataclass(frozen=True, slots=True)
class Rooms:
    """Rooms of a drawing: which modules are in each, and which imports lead from one to another."""

    modules: Mapping[str, tuple[str, ...]]
    arrows: Mapping[tuple[str, str], tuple[Import, ...]]

    def below(self, room: str) -> list[str]:
        """Return the rooms that this one imports."""
        return sorted(to for of, to in self.arrows if of == room)


@dataclass(frozen=True, slots=True)
class Layers:
    """Layers of one contract, the highest first; the siblings of a layer do not import each other."""

    container: str
    """Package that holds the layers, or empty for the packages themselves."""
    floors: tuple[frozenset[str], ...]

    def floor(self, module: str) -> tuple[int, str] | None:
        """Return floor and layer of a module, or None if the contract does not name it."""
        name = module.removeprefix(f"{self.container}.") if self.container else module
        head = name.split(".")[0]
        found = [number for number, names in enumerate(self.floors) if head in names]
        return (found[0], head) if found and (not self.container or name != module) else None


def imports_of(root: Path) -> tuple[frozenset[str], tuple[Import, ...]]:
    """Return all modules below the packages and all imports between them. The packages must be importable."""
    packages = [name for name in PACKAGES if (root / name / "__init__.py").exists()]
    graph = grimp.build_graph(*packages, cache_dir=None)
    found = [Import(of, to) for of in graph.modules for to in graph.find_modules_directly_imported_by(of)]
    return frozenset(graph.modules), tuple(sorted(found))


def rooms_of(modules: Iterable[str], imports: Iterable[Import], package: str) -> Rooms:
    """Return the rooms of one package, with each other package as one room."""
    modules, imports = sorted(modules), list(imports)
    room = _rooms(modules, imports, package)
    inside: dict[str, list[str]] = {}
    for module in modules:
        inside.setdefault(room[module], []).append(module)
    arrows: dict[tuple[str, str], list[Import]] = {}
    for one in imports:
        pair = room[one.importer], room[one.imported]
        if pair[0] != pair[1]:
            arrows.setdefault(pair, []).append(one)
    touched = {name for pair in arrows for name in pair} | {
        name for name in inside if name.startswith(f"{package}/")
    }
    return Rooms(
        {name: tuple(found) for name, found in sorted(inside.items()) if name in touched},
        {pair: tuple(found) for pair, found in sorted(arrows.items())},
    )


def _rooms(modules: list[str], imports: list[Import], package: str) -> dict[str, str]:
    """Return the room of each module."""
    folders = {".".join(module.split(".")[:2]) for module in modules if module.count(".") >= 2}
    room: dict[str, str] = {}
    loose: list[str] = []
    for module in modules:
        top, *rest = module.split(".")
        if top != package:
            room[module] = top
        elif rest and f"{top}.{rest[0]}" in folders:
            room[module] = f"{top}/{rest[0]}"
        else:
            loose.append(module)
    reached = {module: [one.imported for one in imports if one.importer == module] for module in loose}
    ground = set(loose)
    while above := {
        module
        for module in ground
        if any(to.startswith(package) and to not in ground for to in reached[module])
    }:
        ground -= above
    for module in loose:
        name = module.removeprefix(f"{package}.")
        room[module] = f"{package}/{'ground' if module in ground else name}"
    main = f"{package}.__main__"
    if main in room and f"{package}.cli" in folders:
        room[main] = f"{package}/cli"
    return room


def contracts(pyproject: Path) -> list[Layers]:
    """Return the layer contracts of the import linter."""
    configured: dict[str, Any] = tomllib.loads(pyproject.read_text(encoding="utf-8"))["tool"]["importlinter"]
    found: list[Layers] = []
    for contract in configured["contracts"]:
        if contract["type"] == "layers":
            floors = tuple(
                frozenset(name.strip(" ()") for name in layer.split("|")) for layer in contract["layers"]
            )
            found += [Layers(container, floors) for container in contract.get("containers", [""])]
    return found


def broken(rooms: Rooms, layers: Iterable[Layers]) -> list[str]:
    """Return one line for each circle of rooms and each arrow up or to a sibling, naming the files."""
    return [*_circles(rooms), *_upward(rooms, list(layers))]


def _circles(rooms: Rooms) -> list[str]:
    lines: list[str] = []
    done: set[str] = set()
    for start in rooms.modules:
        trail = _way_back(rooms, start, done)
        if trail:
            steps = [rooms.arrows[pair][0] for pair in zip(trail, [*trail[1:], trail[0]], strict=True)]
            shown = "; ".join(f"{file_of(one.importer)} imports {file_of(one.imported)}" for one in steps)
            lines.append(f"circle of rooms {' -> '.join([*trail, trail[0]])}: {shown}")
            done.update(trail)
    return lines


def _way_back(rooms: Rooms, start: str, without: set[str]) -> list[str]:
    """Return the shortest way from a room back to itself, or nothing."""
    trails, seen = [[start]], {start, *without}
    while trails:
        trail = trails.pop(0)
        for to in rooms.below(trail[-1]):
            if to == start:
                return trail
            if to not in seen:
                seen.add(to)
                trails.append([*trail, to])
    return []


def _upward(rooms: Rooms, layers: list[Layers]) -> list[str]:
    lines: list[str] = []
    for found in rooms.arrows.values():
        for one in found:
            for contract in layers:
                high, low = contract.floor(one.importer), contract.floor(one.imported)
                if high and low and high != low and low[0] <= high[0]:
                    lines.append(
                        f"arrow up: {file_of(one.importer)} imports {file_of(one.imported)},"
                        " which is not below it"
                    )
    return sorted(set(lines))


def file_of(module: str) -> str:
    """Return the file of a module, for people to find it."""
    path = Path(*module.split("."))
    return (path / "__init__.py" if path.is_dir() else path.with_suffix(".py")).as_posix()


def without_implied(rooms: Rooms) -> list[tuple[str, str]]:
    """Return the arrows that no longer way implies: they draw the same order with fewer lines."""
    reached: dict[str, set[str]] = {}

    def all_below(room: str) -> set[str]:
        if room not in reached:
            reached[room] = set()
            for to in rooms.below(room):
                reached[room] |= {to} | all_below(to)
        return reached[room]

    return [
        (of, to)
        for of, to in rooms.arrows
        if not any(to in all_below(between) for between in rooms.below(of) if between != to)
    ]


def sentence(room: str, rooms: Rooms, root: Path) -> str:
    """Return what a room holds, in the words of its files: the docstring of its package or file."""
    package, _, name = room.partition("/")
    if name == "ground":
        return "the loose files that import no room: " + ", ".join(
            f"`{module.removeprefix(f'{package}.')}`" for module in rooms.modules[room] if module != package
        )
    path = root / file_of(room.replace("/", "."))
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split()).rstrip(".")
