"""The proof in small: both sides misbehave, no OK is false, nothing is lost or mixed up."""

import os
import subprocess
import sys
import time
from threading import Event

import pytest

from deploy.chaos.plc import MODES, main, run
from deploy.chaos.stalls import Stalls
from station.plc.block.statements import body
from station.plc.block.transcribe import Block, compiled
from station.plc.simulated.line import Fault


@pytest.mark.parametrize("mode", MODES)
def test_no_ok_is_ever_false(mode: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("deploy.chaos.plc.FAULT_FRACTION", 0.05)
    monkeypatch.setattr("deploy.chaos.plc.SLACK", 2.0)
    monkeypatch.setattr("deploy.chaos.plc.WINDOW_S", 0.5)  # a part without a result takes all of it
    report = run(mode, 120, seed=1968)
    assert report.good, report
    assert min(report.faults[str(fault)] for fault in Fault) >= 3, "every fault was injected a few times"
    assert 30 < report.passed < 85


@pytest.mark.parametrize("holds_for_one_call", [True, False])
@pytest.mark.parametrize("mode", MODES)
def test_a_program_without_rest_gets_no_stale_answer_and_the_run_would_notice(
    mode: str, holds_for_one_call: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The block before: its answer stood until the next edge, which this program does not show."""
    text, answer = body(), "PartDone := FALSE;\nPartOk := FALSE;\n"
    assert text.count(answer) == 1
    before = text.replace(answer, "").replace("        Busy := TRUE;", answer + "Busy := TRUE;")
    monkeypatch.setattr(Block, "_code", compiled(text if holds_for_one_call else before))
    monkeypatch.setattr("deploy.chaos.plc.Fault", (Fault.NO_REST,))
    monkeypatch.setattr("deploy.chaos.plc.FAULT_FRACTION", 0.4)
    monkeypatch.setattr("deploy.chaos.plc.LATE_FRACTION", 0.0)
    report = run(mode, 30, seed=1)
    assert report.good is holds_for_one_call, report
    assert report.faults[str(Fault.NO_REST)] >= 5


def test_a_report_that_is_not_good_ends_with_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("deploy.chaos.judge.Judge._run", lambda _: None)
    monkeypatch.setattr("deploy.chaos.plc.FAULT_FRACTION", 0.0)
    monkeypatch.setattr("deploy.chaos.plc.WINDOW_S", 0.1)
    assert main(["--parts", "4", "--mode", "server"]) == 1
    assert "lost results" in capsys.readouterr().out


def test_only_waiting_for_a_processor_counts_as_a_stall() -> None:
    stalls = Stalls()
    Event().wait(0.5)
    assert stalls.since_last_s() < 0.4, "an idle thread waits for no processor"
    only = {min(os.sched_getaffinity(0))}
    before = os.sched_getaffinity(0)
    busy = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    try:
        os.sched_setaffinity(busy.pid, only)
        os.sched_setaffinity(0, only)
        until = time.process_time() + 0.2
        waited_s = 0.0
        while time.process_time() < until or waited_s == 0.0:
            waited_s += stalls.since_last_s()
        assert waited_s > 0.02
    finally:
        os.sched_setaffinity(0, before)
        busy.kill()
        busy.wait()
