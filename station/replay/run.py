"""Judges many images on all cores; after an interruption it continues with those that are left."""

import hashlib
import json
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import asdict
from multiprocessing import get_context, parent_process
from pathlib import Path
from typing import TextIO

from station.errors import ModelError
from station.inspection.inspector import Inspector
from station.inspection.loading import load_inspector
from station.records import Provenance
from station.replay.files import Source
from station.replay.judge import judge_image
from station.replay.replayed import Replayed
from station.replay.results import as_entry, from_entry
from station.settings.model import Settings

AHEAD = 4
"""Number of images queued per process: enough to keep it busy, few enough to stop quickly."""

_inspector: Inspector | None = None


def replay(
    sources: Sequence[Source],
    settings: Settings,
    *,
    judge: tuple[Inspector, Provenance],
    processes: int,
    part: Path | None,
) -> Iterator[Replayed]:
    """Yield a result for each image as soon as it is judged.

    `judge` was loaded from the settings. `part` is the file that makes an interrupted run resumable; the
    caller deletes it. Raises ModelError.
    """
    inspector, provenance = judge
    key = hashlib.sha256(str(asdict(provenance)).encode()).hexdigest()
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
        single = processes == 1 or len(todo) < 2 * processes
        judged = _single(todo, inspector) if single else _pooled(todo, settings, processes)
        for mark, replayed in judged:
            if file is not None and replayed.problem is None:
                file.write(_line(mark, replayed))
                file.flush()
            yield replayed


Marked = tuple[Source, str]
"""Image with the mark that identifies it in the file of an interrupted run."""
Judged = tuple[str, Replayed]
"""Mark of an image with its result."""


def _single(todo: list[Marked], inspector: Inspector) -> Iterator[Judged]:
    for source, mark in todo:
        yield mark, judge_image(inspector, source)


def _pooled(todo: list[Marked], settings: Settings, processes: int) -> Iterator[Judged]:
    model = settings.model.model_copy(update={"threads": 1, "reference_path": None})
    own = settings.model_copy(update={"model": model})
    waiting: list[tuple[str, Future[Replayed]]] = []
    with ProcessPoolExecutor(processes, get_context("spawn"), _begin, (own,)) as pool:
        try:
            for source, mark in todo:
                waiting.append((mark, pool.submit(_judge, source)))
                if len(waiting) >= AHEAD * processes:
                    mark, future = waiting.pop(0)
                    yield mark, future.result()
            for mark, future in waiting:
                yield mark, future.result()
        except BrokenProcessPool:
            raise ModelError(
                "a process of the replay ended unexpectedly, perhaps out of memory; use fewer --processes"
            ) from None
        finally:
            pool.shutdown(cancel_futures=True)


def _begin(settings: Settings) -> None:
    global _inspector  # one for each process of the pool
    import signal
    import threading

    import cv2

    threading.Thread(target=_end_with_parent, daemon=True).start()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent stops the work
    cv2.setNumThreads(1)
    _inspector = load_inspector(settings)[0]


def _end_with_parent() -> None:
    """End this process when its parent ends, because a killed parent cannot end it."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _judge(source: Source) -> Replayed:
    if _inspector is None:
        raise RuntimeError("the process has no inspector")
    return judge_image(_inspector, source)


def _mark(source: Source) -> str:
    try:
        stat = source.path.stat()
        return f"{source.name} {stat.st_size} {stat.st_mtime_ns}"
    except OSError:
        return source.name


def _line(mark: str, replayed: Replayed) -> str:
    """Return the line of a result in the file of an interrupted run; `_known` reads it."""
    entry, warnings = as_entry(replayed), replayed.warnings
    stored = {"name": replayed.name, "entry": entry, "problem": None, "warnings": warnings}
    return json.dumps([mark, stored]) + "\n"


def _known(part: Path, key: str) -> dict[str, Replayed]:
    known: dict[str, Replayed] = {}
    try:
        lines = part.read_text().splitlines()
    except OSError:
        return known
    if not lines or lines[0] != key:
        return known
    for line in lines[1:]:
        try:
            mark, stored = json.loads(line)
            known[mark] = from_entry(stored["name"], stored["entry"], stored["warnings"])
        except (ValueError, KeyError, TypeError, AttributeError, IndexError):
            continue  # the line is incomplete: this image is judged again
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
