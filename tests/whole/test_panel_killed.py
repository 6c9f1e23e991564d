"""A window that is killed, restarted or hangs costs no part."""

from pathlib import Path

from deploy.chaos.panel import run
from station.archive.reader import find


def test_a_killed_or_hanging_window_costs_no_part(tmp_path: Path) -> None:
    reports = run(tmp_path, blocks=1, parts=6, deadline_ms=20_000)
    assert [(report.parts, report.missed) for report in reports.values()] == [(6, 0)] * 3
    assert len(find(tmp_path / "records")) == 18
