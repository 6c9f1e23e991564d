"""The station of the demo as client of a PLC that is the Modbus server."""

import asyncio
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from deploy.demo.ports import free_ports
from deploy.demo.run import main
from deploy.demo.station import shipped_parts
from station.plc.map.registers import VerdictCode
from station.plc.simulated.line import Answer, SimulatedLine
from station.plc.simulated.windows import OwnWindows

ROOT = Path(__file__).resolve().parents[2]
PARTS, PATIENCE_S = 3, 200.0


def test_the_station_of_the_demo_connects_to_a_plc_that_is_the_server(tmp_path: Path) -> None:
    """On a busy machine a part may miss its deadline; each row still tells the part that lay there."""
    port = free_ports(1)[0]
    options = ["--headless", "--preset", "tia", "--port", str(port), "--records", str(tmp_path / "records")]
    station = subprocess.Popen(
        [sys.executable, "-m", "deploy.demo.run", "--station", *options],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
    )

    async def conversation() -> list[Answer]:
        line = SimulatedLine(OwnWindows("127.0.0.1", port), accept_simulated=True)
        await line.connect(10.0)
        try:
            found = []
            for number in range(PARTS):
                found.append(await line.inspect(f"TRY-{number}", PATIENCE_S))
                await line.meanwhile(asyncio.sleep(0.5))
            return found
        finally:
            await line.close()

    try:
        answers = asyncio.run(conversation())
        assert station.poll() is None, "it stays up"
        station.send_signal(signal.SIGINT)
        out, _ = station.communicate(timeout=120)
    finally:
        station.kill()
        station.communicate()
    truths = [part.truth for part in shipped_parts()][:PARTS]
    rows = [line.split() for line in out.splitlines() if line.startswith("trigger")]
    assert [(row[2], row[4]) for row in rows] == [
        (answer.verdict.name, truth.split()[0]) for answer, truth in zip(answers, truths, strict=True)
    ]
    assert all(truth == "OK" for answer, truth in zip(answers, truths, strict=True) if answer.accepted)
    assert {answer.verdict for answer in answers} <= {VerdictCode.OK, VerdictCode.NOK, VerdictCode.ERROR}
    assert station.returncode == 0, out
    assert "AcceptSimulated := TRUE" in out


def test_a_preset_is_of_the_station_alone(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["--preset", "tia"])
    assert "--preset: only with --station" in capsys.readouterr().err
