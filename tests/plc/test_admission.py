"""Who makes room at the server: a PLC keeps its place whatever others do."""

import asyncio
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.plc.wire.access import Access
from station.plc.wire.admission import (
    MAX_CLIENTS,
    MAX_NEWCOMERS,
    PATIENCE_S,
    Place,
    client_to_close,
    newcomer_to_close,
)
from station.plc.wire.peers import Peers

ADDRESSES = "plc", "hmi", "flood"
places = st.lists(
    st.builds(Place, st.integers(1, 10**6), st.sampled_from(ADDRESSES), st.floats(0, 10)),
    min_size=2,
    max_size=40,
    unique_by=lambda place: place.number,
)


def count(found: list[Place], address: str) -> int:
    return sum(place.address == address for place in found)


@given(places, st.sampled_from(ADDRESSES))
def test_a_newcomer_that_had_no_time_is_closed_only_for_one_that_holds_less(
    newcomers: list[Place], address: str
) -> None:
    now_s = 10.0
    closed = newcomer_to_close(newcomers, address, now_s, PATIENCE_S)
    if closed is None:
        assert all(now_s - place.since_s <= PATIENCE_S for place in newcomers), "nobody waits for the idle"
    elif now_s - closed.since_s <= PATIENCE_S:
        assert count(newcomers, closed.address) > count(newcomers, address) + 1
        assert count(newcomers, closed.address) == max(count(newcomers, each) for each in ADDRESSES)
    for place in newcomers:  # it was the turn of the oldest of its address
        if closed is not None and place.address == closed.address:
            assert closed.since_s <= place.since_s


@given(places, st.data())
def test_a_client_is_closed_only_while_no_other_address_holds_more(
    clients: list[Place], data: st.DataObject
) -> None:
    kept = data.draw(st.sampled_from(clients)).number
    closed = client_to_close(clients, (kept, None))
    assert closed.number != kept
    for place in clients:
        if place.number != kept:
            ahead = count(clients, closed.address) - count(clients, place.address)
            assert ahead > 0 or (ahead == 0 and closed.since_s <= place.since_s)


@given(
    st.lists(st.tuples(st.sampled_from(ADDRESSES[1:]), st.floats(0, 0.05)), max_size=300), st.integers(0, 299)
)
def test_one_that_sends_within_its_time_always_becomes_a_client(
    flood: list[tuple[str, float]], at: int
) -> None:
    """The room holds eight; others come at any rate, the PLC at any time, from an address of its own."""
    newcomers: list[Place] = []
    now_s, number, arrived_s = 0.0, 0, None
    for step, (address, wait_s) in enumerate(flood):
        coming = [address]
        if step == at:
            coming.append("plc")
        for name in coming:
            while len(newcomers) >= 8:
                closed = newcomer_to_close(newcomers, name, now_s, PATIENCE_S)
                if closed is not None:
                    newcomers.remove(closed)
                    break
                oldest_s = min(place.since_s for place in newcomers)
                assert now_s <= oldest_s + PATIENCE_S, "each wait ends"
                now_s = oldest_s + PATIENCE_S + 0.001
            number += 1
            newcomers.append(Place(number, name, now_s))
            if name == "plc":
                arrived_s = now_s
        if arrived_s is not None and now_s - arrived_s <= PATIENCE_S:
            assert count(newcomers, "plc") == 1
        now_s += wait_s


class Fake:
    """A connection without a network."""

    def __init__(self, peers: Peers, number: int, name: str = "10.0.0.1") -> None:
        self.peers, self.number, self.name = peers, number, name
        self.since_s, self.role, self.ended = 0.0, None, False

    def end(self, why: str) -> None:
        self.ended = True
        self.peers.remove(self.number)

    def drop(self) -> None:
        self.end("")


def test_readers_do_not_throw_out_the_writer(caplog: pytest.LogCaptureFixture) -> None:
    async def run() -> None:
        peers = Peers(Access())
        fakes = [Fake(peers, number) for number in range(1, MAX_CLIENTS + 10)]
        for fake in fakes:
            peers.admit(fake)
            peers.heard(fake)
            assert fake is not fakes[0] or peers.write_refusal(1) is None
        assert not fakes[0].ended, "the writer is the most silent one and stays"
        assert sum(fake.ended for fake in fakes) == len(fakes) - MAX_CLIENTS
        peers.drop_all()

    asyncio.run(run())
    assert not caplog.records


def test_those_that_sit_there_wait_for_each_other_and_cost_no_client_its_place() -> None:
    async def run() -> None:
        peers = Peers(Access(), patience_s=0.05)
        client = Fake(peers, 0, "plc")
        peers.admit(client)
        peers.heard(client)
        sitters = [Fake(peers, number) for number in range(1, 3 * MAX_NEWCOMERS)]
        for sitter in sitters:
            await peers.room(sitter.name)
            peers.admit(sitter)
        assert sum(not sitter.ended for sitter in sitters) == MAX_NEWCOMERS
        assert not client.ended
        async with asyncio.timeout(20):
            for number in range(3):  # another address need not wait
                await peers.room("hmi")
                peers.admit(Fake(peers, 10_000 + number, "hmi"))
        peers.drop_all()

    asyncio.run(run())


@given(places)
def test_the_order_of_the_places_decides_nothing(found: list[Place]) -> None:
    aged = [replace(place, since_s=number / 100) for number, place in enumerate(found)]
    turned = list(reversed(aged))
    assert newcomer_to_close(aged, "plc", 10.0, 0.5) == newcomer_to_close(turned, "plc", 10.0, 0.5)
    assert client_to_close(aged, ()) == client_to_close(turned, ())
