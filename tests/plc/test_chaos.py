"""The proof in small: both sides misbehave, no OK is false, nothing is lost or mixed up."""

import pytest

from deploy.chaos_plc import MODES, main, run
from station.plc.simulated.line import Knob


@pytest.mark.parametrize("mode", MODES)
def test_no_ok_is_ever_false(mode: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("deploy.chaos_plc.KNOB_SHARE", 0.03)
    monkeypatch.setattr("deploy.chaos_plc.SLACK", 2.0)
    report = run(mode, 70, seed=210)
    assert report.good, report
    assert set(report.knobs) == {str(knob) for knob in Knob}, "every knob was turned"
    assert 25 < report.passed < 55


def test_a_report_that_is_not_good_ends_with_one(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("deploy.judge.Judge._run", lambda _: None)
    monkeypatch.setattr("deploy.chaos_plc.KNOB_SHARE", 0.0)
    monkeypatch.setattr("deploy.chaos_plc.WINDOW_S", 0.1)
    assert main(["--parts", "4", "--mode", "server"]) == 1
    assert "lost results" in capsys.readouterr().out
