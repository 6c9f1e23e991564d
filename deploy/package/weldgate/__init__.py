"""The installed commands; each imports the rooms of this installation, whatever other packages are named.

In a wheel the rooms are in this folder, where no other project finds them; a checkout is used as it is.
"""

import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOMS = ("station", "synth", "models", "deploy")


def run_station() -> int:
    """Run `weldgate`."""
    return _run("station.__main__")


def run_synth() -> int:
    """Run `weldgate-synth`."""
    return _run("synth.__main__")


def run_models() -> int:
    """Run `weldgate-models`."""
    return _run("models.__main__")


def run_demo() -> int:
    """Run `weldgate-demo`."""
    return _run("deploy.demo.run")


def find_rooms() -> None:
    """Put the installed rooms first on the path, which spawned processes inherit.

    Raises ImportError if another package with the name of a room is already loaded.
    """
    if not (HERE / ROOMS[0]).is_dir():
        return
    for room in ROOMS:
        file = getattr(sys.modules.get(room), "__file__", None)
        if file is not None and HERE not in Path(file).resolve().parents:
            raise ImportError(
                f"another package named {room} is already loaded: {file}. Start weldgate without it."
            )
    sys.path.insert(0, str(HERE))


def dask_setup(worker: object) -> None:
    """Prepare a worker of a Dask cluster, started with `dask worker --preload weldgate`."""
    find_rooms()


def _run(module: str) -> int:
    try:
        find_rooms()
    except ImportError as error:
        print(f"weldgate: {error}", file=sys.stderr)
        return 2
    main: Callable[[], int] = import_module(module).main
    return main()
