"""Builds the site: pages, drawing of the rooms, API. Run with `make docs`; every warning is an error."""

import argparse
import shutil
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from deploy.docs.api import write_pages
from deploy.docs.offline import loaded_from_network
from deploy.docs.rooms_page import write_rooms
from deploy.docs.sources import LinkError, stage

ROOT = Path(__file__).resolve().parent.parent.parent
HERE = Path(__file__).resolve().parent


def main(argv: Sequence[str] | None = None) -> int:
    """Build the site; 0 if it is whole, 1 if rooms, links or pages are wrong."""
    parser = argparse.ArgumentParser(
        prog="python -m deploy.docs.build", description="Build the site of the documentation."
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=ROOT / "site",
        metavar="DIR",
        help="write the site here (default: %(default)s)",
    )
    arguments = parser.parse_args(argv)
    out = arguments.out.resolve()
    with tempfile.TemporaryDirectory(prefix="weldgate-docs-") as folder:
        staged = Path(folder) / "pages"
        try:
            count = stage(ROOT, staged)
        except LinkError as error:
            return _failed([str(error)])
        rooms, wrong = write_rooms(ROOT, staged / "rooms.md")
        if wrong:
            return _failed(wrong)
        count += 1 + write_pages(ROOT, staged / "api")
        shutil.rmtree(out, ignore_errors=True)
        if _sphinx(staged, out, Path(folder) / "doctrees"):
            return _failed(["the pages were not built; see above"])
    if remote := list(loaded_from_network(out)):
        return _failed(remote)
    print(f"rooms: {', '.join(rooms)}; no circle, no arrow up")
    print(f"docs: {count} pages; open {out / 'index.html'}")
    return 0


def _sphinx(staged: Path, out: Path, doctrees: Path) -> int:
    from sphinx.cmd.build import build_main

    return build_main(
        [
            "-b",
            "html",
            "-W",
            "--keep-going",
            "-q",
            "-c",
            str(HERE),
            "-d",
            str(doctrees),
            str(staged),
            str(out),
        ]
    )


def _failed(lines: Sequence[str]) -> int:
    for line in lines:
        print(f"docs: {line}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
