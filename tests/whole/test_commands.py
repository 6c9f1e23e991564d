"""The commands as a user types them, in processes of their own."""

import argparse
import asyncio
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from deploy.demo.ports import free_ports
from station.__main__ import _parser, main
from station.archive.reader import read_records
from station.channel.events import StatusEvent
from station.channel.zeromq import Subscriber
from station.plc.map.registers import Offline
from station.plc.simulated.line import SimulatedLine
from station.settings.model import ChannelSettings
from tests.conftest import MODEL, RING_MODEL, ROOT, SEEN_MODEL
from tests.parts import FRAMES, labels


def run(*command: str, **environment: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, "-m", *command],
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


def test_demo_on_the_shipped_frames(tmp_path: Path) -> None:
    out = tmp_path / "out.json"
    count = len(labels())
    done = run(
        "deploy.demo.run",
        "--headless",
        "--parts",
        str(count),
        "--json",
        str(out),
        "--records",
        str(tmp_path / "records"),
    )
    assert done.returncode == 0, done.stdout + done.stderr
    report = json.loads(out.read_text())
    assert [p["truth"] for p in report["parts"]] == [item["truth"] for item in labels()]
    assert (report["escapes"], report["false_rejects"], report["errors"], report["handshakes_complete"]) == (
        0,
        0,
        0,
        count,
    )
    assert sum(e.problem is None for e in read_records(tmp_path / "records")) == count
    replayed = tmp_path / "replay.json"
    assert run("station", "replay", str(tmp_path / "records"), "--json", str(replayed)).returncode == 0
    again = json.loads(replayed.read_text())
    for listed in read_records(tmp_path / "records"):
        record = listed.record
        assert record is not None
        assert listed.shown_to_plc
        entry = again[Path(record.frame_file or "").name]
        assert entry["verdict"] == record.verdict
        assert entry["segments"] == [s.nok for s in record.inspection.scores], "replay is not bit for bit"


def test_replay_names_bad_files_and_judges_the_rest(tmp_path: Path) -> None:
    (tmp_path / "empty.png").write_bytes(b"")
    (tmp_path / "text.bmp").write_text("hello")
    (tmp_path / "notes.txt").write_text("not an image, not looked at")
    (tmp_path / "größe 1.png").write_bytes((FRAMES / labels()[0]["frame"]).read_bytes())
    done = run(
        "station",
        "replay",
        str(tmp_path),
        "--json",
        str(tmp_path / "out.json"),
        "--csv",
        str(tmp_path / "out.csv"),
    )
    assert done.returncode == 1
    assert "empty.png: not a readable image" in done.stderr
    assert "text.bmp: not a readable image" in done.stderr
    report = json.loads((tmp_path / "out.json").read_text())
    assert report["größe 1.png"]["verdict"] == labels()[0]["verdict"]
    assert report["empty.png"]["segments"] == [None] * 21
    assert len((tmp_path / "out.csv").read_text().splitlines()) == 4


SETTINGS = '[camera]\nkind = "pylon"\ndevice_class = "BaslerCamEmu"\nserial = "0815-0000"\n'


@pytest.mark.parametrize(
    ("command", "text", "message"),
    [
        (["engine"], None, "settings file not found"),
        (["engine"], "[camera]\nkind = 3\n", "camera"),
        (["engine"], SETTINGS + '[model]\npath = "none.onnx"\nring_path = "none.onnx"\n', "none.onnx"),
        (["panel"], None, "settings file not found"),
        (["run"], None, "settings file not found"),
    ],
)
def test_mistakes_end_with_one_line_and_code_2(
    command: list[str], text: str | None, message: str, tmp_path: Path
) -> None:
    path = tmp_path / "station.toml"
    if text is not None:
        path.write_text(text)
    done = run("station", *command, "-c", str(path))
    assert done.returncode == 2
    (line,) = [entry for entry in done.stderr.splitlines() if entry.startswith("weldgate:")]
    assert message in line
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "records").exists()


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (["station", "replay", "/nowhere/at/all"], "no such file"),
        (["station", "records", "list", "/nowhere/at/all"], "no records found"),
        (["models", "train", "/nowhere/at/all", "--out", "/tmp"], "weldgate-synth dataset"),
        (["station", "line", "--port", "1", "--parts", "1"], "no Modbus server"),
    ],
)
def test_wrong_paths_end_with_one_line_and_code_2(command: list[str], message: str) -> None:
    done = run(*command)
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr


def test_the_simulated_line_lists_its_faults(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["line", "--list-faults"])
    assert ended.value.code == 0
    assert "silence" in capsys.readouterr().out.splitlines()


@pytest.mark.parametrize("option", ["--fault", "--knob"])
def test_an_unknown_fault_is_refused_under_the_new_and_the_old_name(
    option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["line", "--port", "1", "--parts", "1", option, "earthquake"]) == 2
    message = capsys.readouterr().err
    assert "earthquake" in message
    assert "silence" in message


def parsers(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """Yield a parser and those of its commands."""
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                yield from parsers(command)


def test_every_command_and_option_is_explained_and_the_old_one_is_hidden() -> None:
    found = list(parsers(_parser()))
    assert len(found) == 19
    for parser in found:
        assert re.fullmatch(r"[A-Z].*\.", parser.description or ""), parser.prog
        for action in parser._actions:
            is_a_choice = isinstance(action, argparse._SubParsersAction)
            assert action.help or is_a_choice, f"{parser.prog}: {action.option_strings or action.dest}"
        assert "--knob" not in parser.format_help()


def test_check_says_what_is_wrong(tmp_path: Path) -> None:
    path = tmp_path / "station.toml"
    path.write_text(
        SETTINGS + f'[model]\npath = "{MODEL}"\nring_path = "none.onnx"\n[plc]\nport = {free_ports(1)[0]}\n'
    )
    done = run("station", "check", "-c", str(path))
    assert done.returncode == 1
    assert "BAD  model" in done.stdout
    assert "ok   camera" in done.stdout


def test_an_engine_without_its_camera_comes_up_and_says_so(tmp_path: Path) -> None:
    plc = free_ports(1)[0]
    path = tmp_path / "station.toml"
    path.write_text(
        SETTINGS
        + f'[model]\npath = "{MODEL}"\nring_path = "{RING_MODEL}"\nseen_path = "{SEEN_MODEL}"\n'
        + f"[plc]\nport = {plc}\n"
    )
    engine = subprocess.Popen(
        [sys.executable, "-m", "station", "engine", "-c", str(path)],
        cwd=ROOT,
        env={**os.environ, "PYLON_CAMEMU": "0"},
        stderr=subprocess.PIPE,
        text=True,
    )
    subscriber = Subscriber(ChannelSettings(folder=tmp_path / "channel"))
    try:
        until, heard = time.monotonic() + 300, None
        while time.monotonic() < until and heard is None:
            heard = next((e for e in subscriber.events() if isinstance(e, StatusEvent)), None)
            time.sleep(0.05)
        assert heard is not None
        assert not heard.camera_there
        assert "0815-0000" in heard.camera_message
        assert heard.line.offline in (Offline.CAMERA_LOST, Offline.NOT_ENABLED, Offline.PLC_SILENT)
    finally:
        subscriber.close()
        engine.terminate()
        _, errors = engine.communicate(timeout=600)
    assert engine.returncode == 0, errors
    assert "Traceback" not in errors


def _read_to(process: "subprocess.Popen[str]", text: str, printed: list[str]) -> None:
    """Read what a process prints, up to a line that contains a text or to the end."""
    assert process.stdout is not None
    for line in process.stdout:
        printed.append(line)
        if text in line:
            return


def test_the_station_of_the_demo_stays_up_for_a_plc(
    tmp_path: Path,
) -> None:
    """It has no line of its own, says what the block needs, and ends with Ctrl-C as it should."""
    port, truths = free_ports(1)[0], [item["truth"] for item in labels()][:4]
    command = [sys.executable, "-m", "deploy.demo.run", "--station", "--headless", "--port", str(port)]
    station = subprocess.Popen(
        [*command, "--records", str(tmp_path / "records")], cwd=ROOT, stdout=subprocess.PIPE, text=True
    )

    printed: list[str] = []

    async def conversation() -> list[bool]:
        line = SimulatedLine.at("127.0.0.1", port, accept_simulated=True)
        await line.connect(120.0)
        try:
            assert await line.wait_ready(120.0)
            accepted = []
            for number in range(len(truths)):
                accepted.append((await line.inspect(f"TRY-{number}", 10.0)).accepted)
                # the result is printed when the next part lies in front of the camera, however late that is
                await line.meanwhile(asyncio.to_thread(_read_to, station, f"serial TRY-{number}", printed))
            return accepted
        finally:
            await line.close()

    try:
        accepted = asyncio.run(conversation())
        assert station.poll() is None, "it stays up"
        station.send_signal(signal.SIGINT)
        out = "".join(printed) + station.communicate(timeout=120)[0]
    finally:
        station.kill()
        station.communicate()
    assert accepted == [truth == "OK" for truth in truths]
    assert station.returncode == 0, out
    assert "AcceptSimulated := TRUE" in out
    assert out.count("serial TRY-") == len(truths)
