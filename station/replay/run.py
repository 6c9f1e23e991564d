"""Many images on all cores; what was judged before an interruption is not judged again."""

import hashlib
import json
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import asdict
from multiprocessing import get_context
from pathlib import Path
from typing import Any, TextIO

from station.errors import ModelError
from station.inspection import Inspector
from station.recipe import load_inspector
from station.replay.files import Source
from station.replay.judge import Outcome, judge
from station.settings import Settings

AHEAD = 4
"""Images handed out for each process: enough to keep it busy, few enough to be stopped."""

_inspector: Inspector | None = None


def replay(sources: Sequence[Source], settings: Settings, um_per_px: float, processes: int, part: Path | None) -> Iterator[Outcome]:
    """Outcomes in the order in which they come. `part`: file of an interrupted run, continued and kept until the caller removes it.

    Raises ModelError.
    """
    inspector, provenance = load_inspector(settings)
    key = hashlib.sha256(f"{asdict(provenance)} {um_per_px}".encode()).hexdigest()
    known = {} if part is None else _known(part, key)
    todo = []
    for source in sources:
        mark = _mark(source)
        if mark in known:
            yield known[mark]
        else:
            todo.append((source, mark))
    with ExitStack() as stack:
        file = None if part is None else stack.enter_context(_opened(part, key, bool(known)))
        plain = processes == 1 or len(todo) < 2 * processes
        for mark, outcome in _plainly(todo, inspector, um_per_px) if plain else _pooled(todo, settings, um_per_px, processes):
            if file is not None and outcome.problem is None:
                file.write(json.dumps([mark, asdict(outcome)]) + "\n")
                file.flush()
            yield outcome


Marked = tuple[Source, str]


def _plainly(todo: list[Marked], inspector: Inspector, um_per_px: float) -> Iterator[tuple[str, Outcome]]:
    for source, mark in todo:
        yield mark, judge(inspector, source, um_per_px)


def _pooled(todo: list[Marked], settings: Settings, um_per_px: float, processes: int) -> Iterator[tuple[str, Outcome]]:
    model = settings.model.model_copy(update={"threads": 1, "reference_path": None})
    alone = settings.model_copy(update={"model": model})
    waiting: list[tuple[str, Future[Outcome]]] = []
    with ProcessPoolExecutor(processes, get_context("spawn"), _begin, (alone,)) as pool:
        try:
            for source, mark in todo:
                waiting.append((mark, pool.submit(_judge, source, um_per_px)))
                if len(waiting) >= AHEAD * processes:
                    mark, future = waiting.pop(0)
                    yield mark, future.result()
            for mark, future in waiting:
                yield mark, future.result()
        except BrokenProcessPool:
            raise ModelError("a process of the replay ended, perhaps for lack of memory; use fewer --processes") from None
        finally:
            pool.shutdown(cancel_futures=True)


def _begin(settings: Settings) -> None:
    global _inspector  # one for each process of the pool
    import signal

    import cv2

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends the work
    cv2.setNumThreads(1)
    _inspector = load_inspector(settings)[0]


def _judge(source: Source, um_per_px: float) -> Outcome:
    if _inspector is None:
        raise RuntimeError("the process was not begun")
    return judge(_inspector, source, um_per_px)


def _mark(source: Source) -> str:
    try:
        stat = source.path.stat()
        return f"{source.name} {stat.st_size} {stat.st_mtime_ns}"
    except OSError:
        return source.name


def _known(part: Path, key: str) -> dict[str, Outcome]:
    known: dict[str, Outcome] = {}
    try:
        lines = part.read_text().splitlines()
    except OSError:
        return known
    if not lines or lines[0] != key:
        return known
    for line in lines[1:]:
        try:
            mark, outcome = json.loads(line)
        except ValueError:
            break  # cut off in the middle of a line
        known[mark] = Outcome(outcome["name"], outcome["entry"], outcome["problem"], tuple(outcome["warnings"]))
    return known


def _opened(part: Path, key: str, more: bool) -> TextIO:
    if more:
        whole = part.read_text()
        end = whole.rfind("\n") + 1
        os.truncate(part, len(whole[:end].encode()))
        return part.open("a")
    file = part.open("w")
    file.write(key + "\n")
    file.flush()
    return file


def write_json(path: Path, entries: dict[str, dict[str, Any]]) -> None:
    """The whole report, or nothing. Raises OSError."""
    part = path.with_name(path.name + ".new")
    part.write_text(json.dumps(entries, indent=1))
    part.replace(path)
