"""The page on the rooms: a drawing for each package, made from the imports, with what each room holds."""

from pathlib import Path

from deploy.docs import rooms as found
from deploy.docs.layered import Box, draw
from deploy.docs.rooms import PACKAGES, Rooms

INTRODUCTION = """# Rooms

The code is divided into rooms: folders whose name says what is inside. `make docs` draws this page from the
imports of the code, so it is never out of date. Arrows lead from the room that imports to the room that is
imported. All of them lead down: there is no circle, and no arrow leads back up. `make lint` and `make docs`
fail if one does.

An arrow that a longer way implies is left out. Rest the pointer on a room, or touch it, to see all of its
imports.

Green: loose files that need no other room. Violet: another package.
"""
HEADINGS = {
    "station": "## station: the line PC",
    "synth": "## synth: parts that never existed",
    "models": "## models: what learns from records",
    "deploy": "## deploy: what joins them",
}


def write_rooms(root: Path, path: Path) -> tuple[list[str], list[str]]:
    """Write the page. Return the number of rooms in each drawing and one line for each broken rule."""
    modules, imports = found.imports_of(root)
    layers = found.contracts(root / "pyproject.toml")
    counts: list[str] = []
    wrong: list[str] = []
    text = INTRODUCTION
    for package in PACKAGES:
        rooms = found.rooms_of(modules, imports, package)
        wrong += found.broken(rooms, layers)
        if not wrong:
            counts.append(f"{package} {len(rooms.modules)}")
            text += _section(package, rooms, root)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return counts, sorted(set(wrong))


def _section(package: str, rooms: Rooms, root: Path) -> str:
    own = [name for name in rooms.modules if name.startswith(f"{package}/")]
    said = {name: found.sentence(name, rooms, root) for name in rooms.modules}
    main = found.without_implied(rooms)
    boxes = [Box(name, name.split("/")[-1], _family(name, package), said[name]) for name in rooms.modules]
    drawing = draw(
        boxes,
        main,
        [pair for pair in rooms.arrows if pair not in main],
        f"Rooms of {package} and their imports",
    )
    rows = [
        f"| {_name(name)} | {len(rooms.modules[name])} | {said[name].replace('|', '/')} |" for name in own
    ]
    return "\n".join(
        [
            "",
            HEADINGS[package],
            "",
            "```{raw} html",
            f'<div class="drawing">{drawing}</div>',
            "```",
            "",
            "| room | files | what it holds |",
            "|---|---|---|",
            *rows,
            "",
        ]
    )


def _family(name: str, package: str) -> str:
    return "ground" if name == f"{package}/ground" else "own" if name.startswith(f"{package}/") else "other"


def _name(room: str) -> str:
    package, _, name = room.partition("/")
    return "ground" if name == "ground" else f"{{py:mod}}`{name} <{package}.{name}>`"
