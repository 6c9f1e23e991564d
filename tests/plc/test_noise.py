"""Malformed, truncated, oversized and random frames: the station keeps running and shows no verdict."""

import random
import socket
import struct
import threading
from contextlib import ExitStack

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.plc.line import ModbusLine
from station.plc.map.registers import STATUS_WORDS, Offline
from station.plc.port import Health
from station.plc.wire.framing import frames

FRAMED, NOISE = 92_000, 8_000
BATCH = 10


@given(
    st.lists(st.tuples(st.integers(0, 65535), st.binary(min_size=2, max_size=254)), max_size=6),
    st.integers(0, 1500),
)
def test_frames_come_out_as_they_went_in_wherever_the_stream_is_cut(
    requests: list[tuple[int, bytes]], cut: int
) -> None:
    sent = [struct.pack(">HHH", number, 0, len(body)) + body for number, body in requests]
    stream = b"".join(sent)
    first, used, problem = frames(stream[:cut], 99)
    second, end, other = frames(stream[used:], 99)
    assert (problem, other) == (None, None)
    assert first + second == sent
    assert used + end == len(stream)


def request(rng: random.Random) -> bytes:
    """A frame that a peer may send; none writes into CONTROL, so that no part can start."""
    functions = (1, 2, 3, 4, 7, 8, 11, 12, 17, 20, 21, 24, 43, 99, 127)
    body = bytes([rng.choice((0, 1, 255)), rng.choice(functions)]) + rng.randbytes(rng.randrange(0, 14))
    if rng.random() < 0.4:  # a write into the status window, and beyond
        body = struct.pack(
            ">BBHH",
            1,
            rng.choice((5, 6)),
            rng.randrange(1600, 65536),
            rng.choice((0, 0xFF00, rng.randrange(65536))),
        )
    return struct.pack(">HHH", rng.randrange(65536), 0, len(body)) + body


def noise(rng: random.Random) -> bytes:
    """Not even a frame."""
    kind = rng.randrange(3)
    if kind == 0:
        return rng.randbytes(rng.randrange(1, 400))
    if kind == 1:
        return request(rng)[: rng.randrange(1, 8)]
    return struct.pack(">HHHB", 1, 0, rng.choice((0, 1, 255, 65535)), 1) + rng.randbytes(
        rng.randrange(0, 300)
    )


def status_window(peer: socket.socket) -> list[int]:
    peer.sendall(struct.pack(">HHHBBHH", 9, 0, 6, 1, 3, 100, STATUS_WORDS))
    answer = b""
    while len(answer) < 9 + 2 * STATUS_WORDS:
        more = peer.recv(4096)
        assert more, "the server closed a well-behaved peer"
        answer += more
    return list(struct.unpack(f">{STATUS_WORDS}H", answer[9:]))


def ask(port: int, seed: int, requests: int) -> int:
    """Send requests in batches on one connection; how many were answered."""
    rng, answered = random.Random(seed), 0
    with socket.create_connection(("127.0.0.1", port), timeout=20) as peer:
        stream = peer.makefile("rb")
        for _ in range(requests // BATCH):
            peer.sendall(b"".join(request(rng) for _ in range(BATCH)))
            for _ in range(BATCH):
                length = struct.unpack(">HHH", stream.read(6))[2]
                assert len(stream.read(length)) == length
                answered += 1
        stream.close()
    return answered


def shout(port: int, seed: int, times: int) -> None:
    rng = random.Random(seed)
    for _ in range(times):
        with socket.create_connection(("127.0.0.1", port), timeout=20) as peer:
            peer.sendall(noise(rng))


def test_a_hundred_thousand_frames_of_noise_change_nothing(line: ModbusLine) -> None:
    answered: list[int] = []
    shouting = [
        threading.Thread(target=lambda seed=seed: answered.append(ask(line.port, seed, FRAMED // 2)))
        for seed in (1, 2)
    ]  # type: ignore[misc]
    shouting.append(threading.Thread(target=shout, args=(line.port, 3, NOISE)))
    for thread in shouting:
        thread.start()
    seen = 0
    with socket.create_connection(("127.0.0.1", line.port), timeout=20) as plc:
        while any(thread.is_alive() for thread in shouting):
            words = status_window(plc)
            assert words[5:7] == [0, 0xFFFF]
            assert words[0] & 0b11100000 == 0
            line.check_in(Health(ready=True, offline=Offline.NONE, failure=False, config_crc=7))
            seen += 1
        for thread in shouting:
            thread.join()
        assert answered == [FRAMED // 2] * 2, "every well framed request has its answer"
        assert seen > 3
        before = status_window(plc)[1]
        assert line.next_request(0.15) is None
        assert status_window(plc)[1] != before, "the heartbeat goes on"


def test_a_plc_that_connects_in_the_midst_of_a_flood_is_served_each_time(line: ModbusLine) -> None:
    stop = threading.Event()

    def flood(seed: int) -> None:
        rng = random.Random(seed)
        while not stop.is_set():
            with ExitStack() as volley:
                for _ in range(50):
                    peer = socket.create_connection(("127.0.0.1", line.port), timeout=20)
                    volley.enter_context(peer).sendall(noise(rng))

    shouting = [threading.Thread(target=flood, args=(seed,)) for seed in range(4)]
    for thread in shouting:
        thread.start()
    try:
        for _ in range(300):
            with socket.create_connection(("127.0.0.1", line.port), timeout=20) as plc:
                assert status_window(plc)[5:7] == [0, 0xFFFF]
    finally:
        stop.set()
        for thread in shouting:
            thread.join()


def test_a_peer_that_speaks_no_modbus_is_told_in_the_log(
    line: ModbusLine, caplog: pytest.LogCaptureFixture
) -> None:
    with socket.create_connection(("127.0.0.1", line.port), timeout=20) as peer:
        peer.sendall(b"GET / HTTP/1.0\r\n\r\n")
        assert peer.recv(10) == b""
    assert "does not speak Modbus" in caplog.text
