"""At the window of the demo a newcomer can log in: the code is printed, and the engine accepts it."""

import io
import re
import time
from contextlib import closing
from pathlib import Path

import pytest
from rich.console import Console

from deploy.demo.ports import free_ports
from deploy.demo.stage import staged
from deploy.demo.station import station_toml
from station.channel.request_socket import RequestClient
from station.channel.requests import Answer, LogIn, Message
from station.journal.users import Level
from station.settings.file import load


def test_the_code_that_the_demo_prints_makes_an_administrator(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    said = io.StringIO()
    settings = station_toml(tmp_path / "records", free_ports(1)[0])
    with staged(settings, True, Console(file=said, width=200)) as stage:
        found = re.search(r"code ([\d-]{14}),", said.getvalue())
        assert found, said.getvalue()
        with closing(RequestClient(load(stage.folder / "station.toml").channel)) as window:
            answer = _answer(window, LogIn("Ada", "123456", found[1]))
    assert (answer.refusal, answer.name, answer.level) == ("", "Ada", Level.ADMIN)


def _answer(window: RequestClient, request: LogIn) -> Answer:
    until = time.monotonic() + 120
    while not window.send(Message(request_id=1, token="", sent_s=time.monotonic(), request=request)):
        assert time.monotonic() < until, "the engine does not listen"
        time.sleep(0.1)
    while time.monotonic() < until:
        for answer in window.answers():
            return answer
        time.sleep(0.05)
    raise AssertionError("no answer")
