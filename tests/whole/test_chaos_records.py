"""The proof in small: a writer killed at random moments loses nothing that could have been seen."""

import re
import subprocess
import sys

from tests.conftest import ROOT


def test_kills_lose_nothing_that_could_have_been_seen() -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", "-m", "deploy.chaos.records", "--kills", "40", "--seed", "3"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    found = re.match(r"40 kills, (\d+) verdicts that could have been seen: 0 missing, 0 damaged", done.stdout)
    assert found is not None
    assert int(found[1]) >= 40
