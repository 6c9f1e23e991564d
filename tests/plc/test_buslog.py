import json
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path

import pytest

from station.__main__ import main
from station.errors import RecordError
from station.plc.bus_log import BusLog, Edge, edges, read_bus, tail_bus
from station.plc.map.registers import (
    COMMAND_START,
    COMMAND_WORDS,
    STATUS_START,
    STATUS_WORDS,
    Control,
    Offline,
    Status,
    Value,
    pack_window,
    unpack_window,
)

ON = Control.ENABLE


def command(control: Control, **more: Value) -> dict[str, Value]:
    return unpack_window(
        COMMAND_START, pack_window(COMMAND_START, COMMAND_WORDS, {"CONTROL": int(control), **more})
    )


def status(bits: Status, **more: Value) -> dict[str, Value]:
    return unpack_window(STATUS_START, pack_window(STATUS_START, STATUS_WORDS, {"STATUS": int(bits), **more}))


def changes(held: Control, sent: Control, said: Status, says: Status, **more: Value) -> list[Edge]:
    return list(edges(1_800_000_000.25, (command(held), command(sent)), (status(said), status(says, **more))))


def test_an_edge_has_its_time_in_milliseconds_and_who_made_it() -> None:
    edge, answer = changes(ON, ON | Control.TRIGGER, Status.READY, Status.READY | Status.TRIGGER_ACK)
    assert edge == Edge("2027-01-15T08:00:00.250+00:00", "PLC", "TRIGGER", 1)
    assert (answer.by, answer.name, answer.value) == ("station", "TRIGGER_ACK", 1)


@pytest.mark.parametrize(
    ("held", "sent", "said", "says", "more", "note"),
    [
        (ON, ON | Control.TRIGGER, Status.BUSY, Status.BUSY, {}, "TRIGGER while READY was 0"),
        (ON | Control.TRIGGER, ON, Status.READY, Status.READY, {}, "TRIGGER dropped before TRIGGER_ACK"),
        (ON, ON | Control.RESULT_ACK, Status.READY, Status.READY, {}, "RESULT_ACK without RESULT_VALID"),
        (ON, ON, Status(0), Status.MISSED_TRIGGER, {"ERROR_CODE": 0x2103}, "TRIGGER_ID 0 or repeated"),
        (ON, ON, Status(0), Status.MAINTENANCE, {"ERROR_CODE": 0x2104}, "held too long"),
        (ON, ON | Control.RESULT_ACK, Status.RESULT_VALID, Status(0), {}, "cleared by RESULT_ACK"),
        (
            ON,
            ON | Control.TRIGGER,
            Status.RESULT_VALID | Status.READY,
            Status.BUSY,
            {},
            "cleared by the next TRIGGER",
        ),
        (ON, ON, Status.RESULT_VALID, Status(0), {}, "cleared by the station"),
        (
            ON,
            ON,
            Status.READY,
            Status(0),
            {"OFFLINE_REASON": int(Offline.PLC_SILENT)},
            "PLC_HEARTBEAT does not change",
        ),
    ],
)
def test_who_cleared_what_and_which_rule_was_broken(
    held: Control, sent: Control, said: Status, says: Status, more: dict[str, Value], note: str
) -> None:
    assert any(note in edge.note for edge in changes(held, sent, said, says, **more))


def test_a_clean_handshake_breaks_no_rule() -> None:
    steps = [
        (ON, Status.READY),
        (ON | Control.TRIGGER, Status.READY),
        (ON | Control.TRIGGER, Status.BUSY | Status.TRIGGER_ACK),
        (ON, Status.BUSY | Status.TRIGGER_ACK),
        (ON, Status.RESULT_VALID | Status.OK),
        (ON | Control.RESULT_ACK, Status.RESULT_VALID | Status.OK),
        (ON | Control.RESULT_ACK, Status(0)),
        (ON, Status.READY),
    ]
    found = [
        e for before, after in pairwise(steps) for e in changes(before[0], after[0], before[1], after[1])
    ]
    assert not [e for e in found if "rule broken" in e.note], found
    assert len(found) == 14


def test_edges_are_on_disk_in_order_and_old_files_go(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bus-2020-01-01.jsonl").write_text("")
    recorder = BusLog(tmp_path, days=30)
    for number in range(50):
        recorder(1_800_000_000 + number, command(ON if number % 2 else Control(0)), status(Status(0)))
    recorder.close()
    assert [e.value for e in read_bus(tmp_path)] == [1, 0] * 24 + [1]
    assert [p.name for p in tmp_path.iterdir()] == ["bus-2027-01-15.jsonl"]
    assert main(["records", "bus", str(tmp_path)]) == 0
    assert capsys.readouterr().out.count("ENABLE") == 49


def test_a_line_that_was_cut_off_is_named(tmp_path: Path) -> None:
    recorder = BusLog(tmp_path, days=1)
    for bits in (Control(0), ON, Control(0)):
        recorder(1_800_000_000, command(bits), status(Status(0)))
    recorder.close()
    (path,) = tmp_path.iterdir()
    path.write_text(path.read_text()[:-10])
    with pytest.raises(RecordError, match="line 2"):
        list(read_bus(tmp_path))
    with pytest.raises(RecordError, match="no bus log in this folder"):
        list(read_bus(tmp_path / "absent"))


def test_a_full_disk_costs_edges_and_says_how_many(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recorder = BusLog(tmp_path, days=1)
    write = BusLog._write

    def full(*_arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(BusLog, "_write", full)
    recorder(1_800_000_000, command(Control(0)), status(Status(0)))
    recorder(1_800_000_001, command(ON), status(Status(0)))
    while recorder._left_out == 0:
        pass
    monkeypatch.setattr(BusLog, "_write", write)
    recorder(1_800_000_002, command(Control(0)), status(Status(0)))
    recorder.close()
    lines = [json.loads(line) for path in tmp_path.iterdir() for line in path.read_text().splitlines()]
    assert [(e["name"], e["value"]) for e in lines] == [("ENABLE", 0), ("EDGES_LEFT_OUT", 1)]


def test_what_is_followed_is_what_is_written_also_over_midnight(tmp_path: Path) -> None:
    """Edge by edge, whole lines alone, each once."""
    times = [f"2026-11-2{day}T12:00:00.{i:03d}+00:00" for day in (1, 2) for i in range(50)]
    made = [Edge(time, "PLC", "TRIGGER", i % 2, note="ü" * (i % 7)) for i, time in enumerate(times)]
    lines = [(edge.time[:10], (json.dumps(asdict(edge)) + "\n").encode()) for edge in made]
    followed: list[Edge] = []
    place: tuple[str, int] = ("", 0)
    assert tail_bus(tmp_path, place, 10) == ([], place)
    for number, (day, line) in enumerate(lines):
        half = len(line) // 2
        for part in (line[:half], line[half:]):
            with (tmp_path / f"bus-{day}.jsonl").open("ab") as file:
                file.write(part)
            if number % 3 == 0:
                new, place = tail_bus(tmp_path, place, 1000)
                followed += new
    followed += tail_bus(tmp_path, place, 1000)[0]
    assert followed == made == list(read_bus(tmp_path))


def test_a_late_follower_gets_the_newest_alone(tmp_path: Path) -> None:
    made = [Edge(f"2026-11-21T12:00:00.{i:03d}+00:00", "station", "READY", i % 2) for i in range(500)]
    (tmp_path / "bus-2026-11-21.jsonl").write_text("".join(json.dumps(asdict(edge)) + "\n" for edge in made))
    found, _ = tail_bus(tmp_path, ("", 0), 20)
    assert found == made[-20:]


def test_a_spoilt_line_is_said_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "bus-2026-11-21.jsonl").write_text("{spoilt\n")
    with pytest.raises(RecordError, match="truncated or modified"):
        tail_bus(tmp_path, ("", 0), 20)
