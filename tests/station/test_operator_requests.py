"""Windows and engine over the real channel: every request is answered, even if windows are killed."""

import socket
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from deploy.demo.ports import free_ports
from deploy.demo.station import station_toml
from station.archive.schema import open_index
from station.channel.request_socket import MAX_BYTES, REQUESTS
from station.channel.requests import (
    Acknowledge,
    Changed,
    ChangeSettings,
    HoldService,
    LogIn,
    LogOut,
    ReloadSettings,
    ResetCounts,
    StayLoggedIn,
    TakeTestImage,
)
from station.channel.sockets import socket_path
from station.engine import active_settings as released
from station.engine import orders
from station.engine.orders import UseSettings
from station.inspection.loading import prepare
from station.journal.journal import Kind, entries
from station.journal.users import Level
from station.settings import adjustments
from station.settings.file import load
from tests.desk import PIN, Desk, PlainWindow

SHARPNESS = ("recipes", "1", "quality", "min_sharpness")
OLD, NEW = {}, {"recipes": {"1": {"quality": {"min_sharpness": 0.02}}}}
CHANGE = ChangeSettings((Changed(SHARPNESS, 0.02),), "trial of the limit")


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    made = tmp_path / "station.toml"
    made.write_text(station_toml(tmp_path / "records", free_ports(1)[0]))
    (tmp_path / "records").mkdir()
    open_index(tmp_path / "records").close()
    loaded = prepare(load(made), 1)
    monkeypatch.setattr(released, "prepare", lambda _settings, _number: loaded)
    return made


@pytest.fixture
def desk(path: Path) -> Iterator[Desk]:
    made = Desk(path)
    made.knows("Quentin", Level.QUALITY)
    yield made
    made.close()


@pytest.fixture
def window(desk: Desk) -> Iterator[PlainWindow]:
    made = PlainWindow(desk.path)
    assert made.ask(LogIn("Quentin", PIN)).done
    yield made
    made.close()


def settings_noted(desk: Desk) -> list[tuple[str, str, str]]:
    found = entries(desk.active.settings.archive.folder, (Kind.SETTING,), newest_first=False)
    return [(e.who, e.after, e.reason) for e in found]


def test_a_change_is_answered_once_it_is_in_use(desk: Desk, window: PlainWindow) -> None:
    assert window.ask(CHANGE).done
    assert adjustments.read(desk.path) == NEW
    assert len(desk.used) == 1
    refused = window.ask(ChangeSettings((Changed(SHARPNESS, -1.0),), "trial of the limit"))
    assert "greater than or equal to 0" in refused.refusal
    assert "\n" not in refused.refusal
    assert adjustments.read(desk.path) == NEW


def test_a_window_killed_in_any_step_of_a_change_leaves_the_old_settings_or_the_new_ones(desk: Desk) -> None:
    """A window sends one message and receives one: it can be killed before, between and after."""
    for step, expected in (
        ("before it has sent", OLD),
        ("before it has heard", NEW),
        ("after it has heard", NEW),
    ):
        window = PlainWindow(desk.path)
        window.ask(LogIn("Quentin", PIN))
        number = None if expected is OLD else window.send(CHANGE)
        if step == "after it has heard" and number is not None:
            assert window.answer(number).done
        window.close()
        end = time.monotonic() + 5
        while adjustments.read(desk.path) != expected:
            assert time.monotonic() < end, step
            time.sleep(0.01)
        load(desk.path)
        assert desk.requests is not None


def test_a_request_cut_off_on_its_way_changes_nothing_and_ends_nothing(
    desk: Desk, window: PlainWindow
) -> None:
    peer = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    peer.connect(str(socket_path(desk.active.settings.channel.folder, REQUESTS)))
    for rubbish in (
        b"{",
        b"[]",
        b'{"request_id": 1}',
        b"\xff" * 1000,
        b'{"request_id": 1, "sent_s": 0, "request": {"type": "log',
    ):
        peer.send(rubbish)
    peer.send(b"x" * (MAX_BYTES + 1))
    assert window.ask(StayLoggedIn(True)).done
    peer.settimeout(10)
    assert peer.recv(100) == b"", "what is not understood is not answered, what is too long disconnected"
    peer.close()
    assert adjustments.read(desk.path) == OLD


def test_changes_of_two_windows_come_one_after_the_other(desk: Desk, window: PlainWindow) -> None:
    other = PlainWindow(desk.path)
    other.ask(LogIn("Root", PIN))
    desk.turns = False
    first = window.send(CHANGE)
    second = other.send(
        ChangeSettings((Changed(("recipes", "1", "quality", "max_dark_share"), 0.5),), "trial too")
    )
    assert window.ask(StayLoggedIn(True)).done, "others are served while a change waits for its moment"
    assert other.ask(TakeTestImage()).done
    assert sum(isinstance(order, UseSettings) for order in desk.given) <= 1
    assert adjustments.read(desk.path) == OLD
    desk.turns = True
    assert window.answer(first).done
    assert other.answer(second).done
    assert adjustments.read(desk.path) == {
        "recipes": {"1": {"quality": {"min_sharpness": 0.02, "max_dark_share": 0.5}}}
    }
    assert sorted(who for who, _, _ in settings_noted(desk)) == ["Quentin", "Root"]
    other.close()


def test_an_engine_that_stops_meanwhile_answers_nothing_and_changes_nothing(path: Path) -> None:
    desk = Desk(path, turns=False)
    desk.knows("Quentin", Level.QUALITY)
    window = PlainWindow(path)
    window.ask(LogIn("Quentin", PIN))
    window.send(CHANGE)
    window.until(lambda: bool(desk.given))
    desk.close()
    window.close()
    assert adjustments.read(path) == OLD
    assert settings_noted(desk)[-1][2].startswith("refused: ")
    again = Desk(path)
    try:
        window = PlainWindow(path)
        assert not window.ask(StayLoggedIn(True)).logged_in, "who was logged in logs in again"
        assert window.ask(LogIn("Quentin", PIN)).done
        window.close()
    finally:
        again.close()


def test_a_file_edited_by_hand_is_read_again_on_request(desk: Desk, window: PlainWindow) -> None:
    adjustments.path_of(desk.path).write_text('{"recipes": {"1": {"quality": {"min_sharpness": 0.02}}}}')
    assert window.ask(ReloadSettings()).done
    assert desk.active.settings.recipes[1].quality == {"min_sharpness": 0.02}
    assert settings_noted(desk) == [("Quentin", "read again", "")]


def test_a_flood_of_one_window_keeps_no_other_from_its_answer(desk: Desk, window: PlainWindow) -> None:
    flood = PlainWindow(desk.path)
    kinds = (ResetCounts(), Acknowledge(1), LogIn("Nobody", "0"), StayLoggedIn(True))
    numbers = [flood.send(kinds[number % len(kinds)]) for number in range(90)]
    for _ in range(3):
        assert window.ask(StayLoggedIn(True)).done
    assert all(not flood.answer(number).done for number in numbers)
    assert desk.given == []
    flood.close()


def test_a_login_ends_with_the_window_and_service_mode_with_the_login(
    desk: Desk, window: PlainWindow
) -> None:
    assert window.ask(HoldService()).done
    assert window.ask(LogOut("window closed")).done
    window.until(lambda: bool(desk.given) and desk.given[-1] == orders.Service("Quentin", ended=True))
    assert window.ask(ResetCounts()).refusal == "a login of the level setter is needed"
