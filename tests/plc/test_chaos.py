"""The proof in small: both sides misbehave, no OK is false, nothing is lost or mixed up."""

import pytest

from deploy.chaos.plc import MODES, main, run
from station.plc.simulated.line import Fault


@pytest.mark.parametrize("mode", MODES)
def test_no_ok_is_ever_false(mode: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("deploy.chaos.plc.FAULT_FRACTION", 0.05)
    monkeypatch.setattr("deploy.chaos.plc.SLACK", 2.0)
    monkeypatch.setattr("deploy.chaos.plc.WINDOW_S", 0.5)  # a part without a result takes all of it
    report = run(mode, 70, seed=1968)
    assert report.good, report
    assert min(report.faults[str(fault)] for fault in Fault) >= 3, "every fault was injected a few times"
    assert 25 < report.passed < 55


def test_a_report_that_is_not_good_ends_with_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("deploy.chaos.judge.Judge._run", lambda _: None)
    monkeypatch.setattr("deploy.chaos.plc.FAULT_FRACTION", 0.0)
    monkeypatch.setattr("deploy.chaos.plc.WINDOW_S", 0.1)
    assert main(["--parts", "4", "--mode", "server"]) == 1
    assert "lost results" in capsys.readouterr().out
