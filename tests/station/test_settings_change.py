"""A change of settings happens completely or not at all, even if the engine is killed."""

import gc
import json
import sqlite3
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from types import FrameType

import pytest

from station.camera.reconnecting import ReconnectingCamera
from station.channel.requests import FAULT, Changed
from station.engine import active_settings as released
from station.engine.active_settings import ActiveSettings
from station.engine.orders import Order, OrderQueue, Reload, Ticket, UseSettings
from station.engine.settings_change import DIFFERENT_IN_FILE, NO_MOMENT, NOT_IN_FILE, SettingsChange
from station.engine.settings_use import CAMERA_REFUSES, use_settings
from station.errors import ModelError, SettingsError
from station.files.sqlite import connect_to_write
from station.inspection.loading import Loaded, prepare
from station.journal.journal import Kind, entries
from station.settings import adjustments
from station.settings.file import load
from station.settings.model import Settings
from tests.conftest import MODEL, RING_MODEL, SEEN_MODEL
from tests.desk import StubCamera

REASON = "trial of the limit"
SHARPNESS = ("recipes", "1", "quality", "min_sharpness")
NEW = {"recipes": {"1": {"quality": {"min_sharpness": 0.02}}}}


class Engine:
    """The parts of an engine that a change passes; the cycle has its turn in its own thread, or never."""

    def __init__(self, path: Path, turns: bool = True) -> None:
        self.path, self.queue, self.stop = path, OrderQueue(), threading.Event()
        self.active = ActiveSettings(load(path), lambda: load(path), StubCamera)
        self.camera = ReconnectingCamera(self.active.make_camera(), 1.0)
        self.camera.keep_open()
        self.used: list[Loaded] = []
        self.change = SettingsChange(
            path, self.active, hand_over=self.queue.put, recipe=lambda: 1, stop=self.stop
        )
        self._turns, self._thread = turns, threading.Thread(target=self._run)
        self._thread.start()

    def _run(self) -> None:
        while not self.stop.wait(0.005):
            for order in self.queue.take() if self._turns else ():
                self.carry_out(order)

    def carry_out(self, order: Order) -> None:
        if isinstance(order, UseSettings) and order.ticket.take():
            use_settings(order, active=self.active, camera=self.camera, number=1, use=self.used.append)
        elif isinstance(order, Reload) and order.ticket.take():
            order.ticket.answer("")

    def change_to(self, value: float, place: tuple[str, ...] = SHARPNESS) -> None:
        self.change.make("Quentin", (Changed(place, value),), REASON)

    def close(self) -> None:
        self.stop.set()
        self._thread.join(timeout=100)

    def noted(self) -> list[tuple[str, str, str, str]]:
        found = entries(self.path.parent / "records", (Kind.SETTING,), newest_first=False)
        return [(e.subject, e.before, e.after, e.reason) for e in found]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "records").mkdir()
    made = tmp_path / "station.toml"
    made.write_text(f"""
[camera]
kind = "pylon"
serial = "0815"
[model]
path = "{MODEL}"
ring_path = "{RING_MODEL}"
seen_path = "{SEEN_MODEL}"
""")
    return made


@pytest.fixture
def engine(path: Path) -> Iterator[Engine]:
    made = Engine(path)
    yield made
    made.close()


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch, path: Path) -> Loaded:
    """Networks are loaded once: what they are is not the point."""
    loaded = prepare(load(path), 1)
    monkeypatch.setattr(released, "prepare", lambda _settings, _number: loaded)
    return loaded


def test_a_change_is_noted_used_and_in_the_file(engine: Engine) -> None:
    engine.change_to(0.02)
    assert adjustments.read(engine.path) == NEW
    assert engine.active.settings == load(engine.path)
    assert engine.used[0].provenance.config_crc != prepare(load(engine.path, {}), 1).provenance.config_crc
    assert engine.noted() == [(".".join(SHARPNESS), "0.01", "0.02", REASON)]
    assert list(engine.path.parent.glob("*.part")) == []
    start = engine.active.settings
    engine.change.note_unfinished()
    assert len(engine.noted()) == 1, "the journal says what the file says"
    assert start is engine.active.settings


@pytest.mark.parametrize(
    ("place", "value", "why"),
    [
        (SHARPNESS, -1.0, "min_sharpness: Input should be greater than or equal to 0"),
        (("recipes", "1", "quality", "nonsense"), 1.0, "Extra inputs are not permitted"),
        (("recipes", "7", "quality", "min_sharpness"), 0.02, "recipe 7 does not exist"),
        (("recipes", "x", "quality", "min_sharpness"), 0.02, "recipes.x"),
        (("recipes", "1", "model", "path"), 1.0, "cannot be changed at the station"),
        (("recipes", "1"), 1.0, "cannot be changed at the station"),
        (("camera", "exposure_us"), 0.5, CAMERA_REFUSES),
        (("camera", "serial"), 5.0, "camera.serial"),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line_and_leaves_everything(
    engine: Engine, place: tuple[str, ...], value: float, why: str
) -> None:
    engine.change_to(0.02)
    before, settings = adjustments.read(engine.path), engine.active.settings
    noted = len(engine.noted())
    with pytest.raises(SettingsError, match=why.replace(".", r"\.")) as refused:
        engine.change_to(value, place)
    assert "\n" not in str(refused.value)
    assert (adjustments.read(engine.path), engine.active.settings) == (before, settings)
    told = engine.noted()[noted:]
    assert not told or [(told[0][2], REASON), (told[1][1], f"refused: {refused.value}")] == [
        (told[1][1], REASON),
        (told[0][2], f"refused: {refused.value}"),
    ]
    engine.change.note_unfinished()
    assert len(engine.noted()) == noted + len(told)


def test_a_reason_is_needed_and_nothing_noted_without(engine: Engine) -> None:
    with pytest.raises(SettingsError, match="a reason is needed"):
        engine.change.make("Quentin", (Changed(SHARPNESS, 0.02),), " abc ")
    assert engine.noted() == []


def test_a_network_that_does_not_load_is_refused(engine: Engine, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(_settings: Settings, _number: int) -> Loaded:
        raise ModelError("model.onnx: damaged")

    monkeypatch.setattr(released, "prepare", broken)
    with pytest.raises(ModelError, match="damaged"):
        engine.change_to(0.02)
    assert adjustments.read(engine.path) == {}
    assert engine.noted()[-1][3] == "refused: model.onnx: damaged"


def test_a_fault_on_the_way_is_noted_as_a_refusal(engine: Engine, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(_settings: Settings, _number: int) -> Loaded:
        raise ZeroDivisionError

    monkeypatch.setattr(released, "prepare", broken)
    with pytest.raises(ZeroDivisionError):
        engine.change_to(0.02)
    assert adjustments.read(engine.path) == {}
    assert engine.noted()[-1][1:] == ("0.02", "0.01", f"refused: {FAULT}")


def test_a_file_that_cannot_be_replaced_leaves_camera_and_settings(
    engine: Engine, quick: Loaded, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_part: Path, _target: Path) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    before = engine.active.settings
    with pytest.raises(SettingsError, match="No space left on device"):
        engine.change_to(900.0, ("camera", "exposure_us"))
    assert engine.active.settings is before
    assert isinstance(engine.camera._camera, StubCamera)
    assert engine.camera._camera.exposure_us == 2000.0
    assert engine.camera.connected
    assert engine.used == []


def test_a_cycle_that_never_has_a_moment_changes_nothing_later(
    path: Path, quick: Loaded, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("station.engine.settings_change.PATIENCE_S", 0.2)
    engine = Engine(path, turns=False)
    try:
        with pytest.raises(SettingsError, match=NO_MOMENT):
            engine.change_to(0.02)
        for order in engine.queue.take():
            engine.carry_out(order)
        assert (adjustments.read(path), engine.used) == ({}, [])
        assert engine.noted()[-1][3] == f"refused: {NO_MOMENT}"
    finally:
        engine.close()


def test_a_ticket_is_taken_or_withdrawn_never_both() -> None:
    for _ in range(200):
        ticket, stop, taken = Ticket(), threading.Event(), list[bool]()

        def cycle(ticket: Ticket = ticket, taken: list[bool] = taken) -> None:
            taken.append(ticket.take())
            ticket.answer("done")

        thread = threading.Thread(target=cycle)
        stop.set()
        thread.start()
        outcome = ticket.wait(0.0, stop)
        thread.join()
        assert taken == [outcome is not None]


class Killed(BaseException):
    """The process has ended: nothing of it runs any more, no handler either."""


WATCHED = (
    "station/engine/active_settings.py",
    "station/engine/settings_change.py",
    "station/engine/settings_use.py",
    "station/files/durable.py",
    "station/journal/journal_writer.py",
    "station/settings/adjustments.py",
    "station/settings/file.py",
)


def killed_at(line: int, work: Callable[[], None]) -> bool:
    """Return whether the work was cut off when it had reached so many lines of the watched files."""
    left = line

    def trace(frame: FrameType, event: str, _arg: object) -> object:
        nonlocal left
        if not frame.f_code.co_filename.endswith(WATCHED):
            return None
        if event == "line":
            left -= 1
            if left <= 0:
                raise Killed
        return trace

    sys.settrace(trace)  # type: ignore[arg-type]
    try:
        work()
    except Killed:
        return True
    finally:
        sys.settrace(None)
    return False


def all_in_one_thread(path: Path, used: list[Loaded]) -> SettingsChange:
    """Return a change in which the cycle has its turn at once, so that every step can be cut off."""
    made = ActiveSettings(load(path), lambda: load(path), StubCamera)
    camera = ReconnectingCamera(made.make_camera(), 1.0)

    def at_once(order: Order) -> None:
        assert isinstance(order, UseSettings)
        order.ticket.take()
        use_settings(order, active=made, camera=camera, number=1, use=used.append)

    return SettingsChange(path, made, hand_over=at_once, recipe=lambda: 1, stop=threading.Event())


@pytest.fixture
def files_left_open() -> Iterator[None]:
    """Allow unclosed files: a killed process closes none."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        yield
        gc.collect()


@pytest.fixture
def no_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wait neither for the disk nor for the maker of a journal without tables, who is dead."""

    def quick(path: Path, *, any_thread: bool = False) -> sqlite3.Connection:
        connection = connect_to_write(path, any_thread=any_thread)
        connection.execute("PRAGMA synchronous = OFF")
        return connection

    monkeypatch.setattr("os.fsync", lambda _file: None)
    monkeypatch.setattr("station.files.sqlite.PATIENCE_S", 0.0)
    monkeypatch.setattr("station.files.sqlite.connect_to_write", quick)


@pytest.mark.usefixtures("files_left_open", "no_waiting")
def test_an_engine_killed_in_any_step_leaves_the_old_file_or_the_new_one(path: Path, quick: Loaded) -> None:
    old = {"recipes": {"1": {"quality": {"min_sharpness": 0.005}}}}
    new = {**NEW, "camera": {"gain_db": 3.0}}
    values = (Changed(SHARPNESS, 0.02), Changed(("camera", "gain_db"), 3.0))
    seen, used, line, killed = set[float](), list[Loaded](), 0, True
    while killed:
        line, used = line + 1, []
        adjustments.path_of(path).write_text(json.dumps(old))
        killed = killed_at(line, partial(all_in_one_thread(path, used).make, "Quentin", values, REASON))
        after, started = adjustments.read(path), load(path)
        assert after in (old, new)
        seen.add(started.recipes[1].quality["min_sharpness"])
        assert not used or after == new, "never judged by what is not in the file"
        all_in_one_thread(path, []).note_unfinished()
        told = {e.subject: e for e in entries(path.parent / "records", (Kind.SETTING,), newest_first=False)}
        for subject, entry in told.items():
            value = adjustments.at(after, subject.split("."))
            said = entry.reason if value is None else entry.after
            assert said == (NOT_IN_FILE if value is None else f"{value:g}"), (
                "the journal says what the file says"
            )
    assert seen == {0.005, 0.02}, "killed before and after"
    assert line > 350, "all files of WATCHED are on the way"
    assert adjustments.read(path) == new


def test_changes_of_two_windows_come_one_after_the_other_and_keep_each_other(
    engine: Engine, quick: Loaded
) -> None:
    engine.change_to(0.02)
    engine.change_to(0.5, ("recipes", "1", "quality", "max_dark_share"))
    engine.change.make(
        "Ada", (Changed(("recipes", "1", "model", "segment_thresholds"), {3: 0.6}, shown={}),), REASON
    )
    assert load(engine.path).recipes[1].quality == {"min_sharpness": 0.02, "max_dark_share": 0.5}
    assert engine.active.settings.recipes[1].model == load(engine.path).recipes[1].model
    engine.change.note_unfinished()
    assert engine.noted()[-1] == ("recipes.1.model.segment_thresholds", "{}", "{3: 0.6}", REASON)


def test_what_was_edited_by_hand_meanwhile_is_noted_at_the_next_start(engine: Engine, quick: Loaded) -> None:
    engine.change_to(0.02)
    adjustments.path_of(engine.path).write_text('{"recipes": {"1": {"quality": {"min_sharpness": 0.03}}}}')
    engine.change.note_unfinished()
    adjustments.path_of(engine.path).unlink()
    for _ in range(2):
        engine.change.note_unfinished()
    subject = ".".join(SHARPNESS)
    assert engine.noted()[1:] == [
        (subject, "0.02", "0.03", DIFFERENT_IN_FILE),
        (subject, "0.03", "0.02", NOT_IN_FILE),
    ]
