"""Checks of the station itself: image drift, the checks of masters, and the self-test on a stored frame."""

import logging
import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from station.classify.drift import Drift, DriftWatch
from station.domain import Inspection, Verdict
from station.inspection.loading import Loaded
from station.records import Provenance

log = logging.getLogger("weldgate.watch")

RETEST_S = 1.0
"""Time between two self-tests while they fail."""


@dataclass(frozen=True, slots=True)
class Master:
    """A part of known verdict."""

    expected: Verdict
    found: Verdict | None = None
    """Verdict at its last check; None if it was never checked."""
    checked_s: float = 0.0
    """Epoch seconds of the last check."""

    @property
    def wrong(self) -> bool:
        """True if its last check gave another verdict than expected."""
        return self.found not in (None, self.expected)


History = dict[tuple[str, Provenance], Master]
"""Last check of each master, by its serial, by each judge."""


class SelfChecks:
    """Results of the self-checks; they decide whether the station's verdicts can be trusted."""

    def __init__(
        self,
        loaded: Loaded,
        masters: Mapping[str, Master],
        due_s: float | None,
        self_test_s: float,
        *,
        self_test_age_s: float = float("inf"),
        history: History | None = None,
    ) -> None:
        """`masters`: by serial; `due_s`: interval of checks; `history`: checks before this start.

        `self_test_s`: time between self-tests while no part comes; `self_test_age_s`: highest age of the last
        one between two parts.
        """
        self._masters, self._due_s = dict(masters), due_s
        self._self_test_s, self._self_test_age_s = self_test_s, self_test_age_s
        self._judge = loaded.provenance
        self._history: History = {} if history is None else dict(history)
        self.self_test_failed = False
        """True from a self-test that failed to the next one that passes, by whatever recipe."""
        self.use(loaded)

    def use(self, loaded: Loaded) -> None:
        """Check by another recipe from now on. That does not make good a self-test that failed."""
        reference = loaded.inspector.reference
        self._drift_watch = None if reference is None else DriftWatch(reference)
        self.drift: Drift | None = None
        """Drift after the last judged part; None if it is not monitored."""
        self._self_test = loaded.self_test
        self._tested_s = self._judged_s = time.monotonic()
        if loaded.provenance != self._judge:
            self._masters = {
                serial: master
                if master.wrong
                else self._history.get((serial, loaded.provenance), Master(master.expected))
                for serial, master in self._masters.items()
            }
        self._judge = loaded.provenance

    @property
    def drifting(self) -> bool:
        """True if the images have drifted away from the reference."""
        return self.drift is not None and self.drift.alarm

    @property
    def trusted(self) -> bool:
        """True if OK may be published: no master was misjudged and the self-test passes."""
        return not self.master_wrong and not self.self_test_failed

    @property
    def master_wrong(self) -> bool:
        """True if a master was misjudged and has not been judged correctly since."""
        return any(master.wrong for master in self._masters.values())

    @property
    def masters_due(self) -> bool:
        """True if the check of a master is due."""
        return self._due_s is not None and any(
            time.time() - master.checked_s > self._due_s for master in self._masters.values()
        )

    def part_judged(self, inspection: Inspection) -> None:
        """Follow the drift by a part that was judged."""
        self._judged_s = time.monotonic()
        if self._drift_watch is None or not inspection.look:
            return
        before, self.drift = self.drifting, self._drift_watch.part(np.array(inspection.look))
        if self.drifting and not before:
            log.warning(
                "image drift: %.2f is above the limit %.2f; check light, focus and surface",
                self.drift.value,
                self.drift.limit,
            )
        elif before and not self.drifting:
            log.info("image drift has ended (%.2f)", self.drift.value)

    def master_judged(self, serial: str, found: Verdict) -> None:
        """Compare the verdict on a master with the expected one."""
        master = self._masters.get(serial)
        if master is None:
            log.warning("master check: unknown master %r; add it under [golden.masters]", serial)
            return
        self._masters[serial] = Master(master.expected, found, time.time())
        self._history[serial, self._judge] = self._masters[serial]
        if found is master.expected:
            log.info("master check: master %s was judged %s as expected", serial, found)
        else:
            log.error(
                "master check: master %s was judged %s instead of %s; no part is released until it is right",
                serial,
                found,
                master.expected,
            )

    def run_when_idle(self) -> None:
        """Run the self-test if it is time; call only while no part is there."""
        wait_s = RETEST_S if self.self_test_failed else self._self_test_s
        if time.monotonic() - max(self._tested_s, self._judged_s) >= wait_s:
            self._run_self_test()

    def run_between_parts(self) -> None:
        """Run the self-test if the last one is too old; call after each part."""
        if time.monotonic() - self._tested_s >= self._self_test_age_s:
            self._run_self_test()

    def _run_self_test(self) -> None:
        if self._self_test is None:
            return
        try:
            failed = not self._self_test.passes()
        except Exception:
            log.exception("self-test failed with an error")
            failed = True
        self._tested_s = time.monotonic()
        if failed and not self.self_test_failed:
            log.error(
                "self-test failed: the stored frame is judged differently;"
                " restart the station, check the PC's memory"
            )
        elif self.self_test_failed and not failed:
            log.info("self-test passed again")
        self.self_test_failed = failed
