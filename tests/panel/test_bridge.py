"""A window that ends while events come ends quietly."""

from pathlib import Path

from pytestqt.qtbot import QtBot

from station.channel.request_socket import RequestClient
from station.channel.requests import Answer
from station.channel.zeromq import Subscriber
from station.panel.session.bridge import Bridge
from station.settings.model import ChannelSettings


def test_a_bridge_that_is_closed_while_it_polls_reads_nothing_more(qtbot: QtBot, tmp_path: Path) -> None:
    channel = ChannelSettings(folder=tmp_path / "channel")
    bridge = Bridge(Subscriber(channel), RequestClient(channel))
    bridge.answer.connect(lambda _: bridge.close())
    bridge._client.answers = lambda: [Answer(1)]  # type: ignore[method-assign]
    bridge.poll()
    bridge.poll()
    assert not bridge._timer.isActive()
