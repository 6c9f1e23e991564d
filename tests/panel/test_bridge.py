"""A window that ends while events come ends quietly."""

from pytestqt.qtbot import QtBot

from deploy.demo.ports import free_ports
from station.channel.requests import Answer
from station.channel.zeromq import RequestClient, Subscriber
from station.panel.session.bridge import Bridge
from station.settings.model import ChannelSettings


def test_a_bridge_that_is_closed_while_it_polls_reads_nothing_more(qtbot: QtBot) -> None:
    events, preview, requests = free_ports(3)
    channel = ChannelSettings(events_port=events, preview_port=preview, requests_port=requests)
    bridge = Bridge(Subscriber(channel), RequestClient(channel))
    bridge.answer.connect(lambda _: bridge.close())
    bridge._client.answers = lambda: [Answer(1)]  # type: ignore[method-assign]
    bridge.poll()
    bridge.poll()
    assert not bridge._timer.isActive()
