"""What the station watches of itself: drifting pictures, masters judged wrongly, a stored frame judged differently."""

import logging
import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from station.classify.drift import Drift, DriftWatch
from station.domain import Inspection, Verdict
from station.inspection.loading import Loaded

log = logging.getLogger("weldgate.watch")

AGAIN_S = 1.0
"""Between two self-tests while they fail."""


@dataclass(frozen=True, slots=True)
class Master:
    """A part known to be good or bad."""

    expected: Verdict
    found: Verdict | None = None
    """At its last check; None: never checked."""
    checked_s: float = 0.0
    """Epoch seconds of the last check."""


class Watch:
    """Hears of every part; tells what the PLC must know beside the verdicts."""

    def __init__(
        self, loaded: Loaded, masters: Mapping[str, Master], due_s: float | None, self_test_s: float
    ) -> None:
        """`masters` by serial; `due_s`: a master not judged for so long is due; `self_test_s`: idle time between two self-tests."""
        self._masters, self._due_s, self._self_test_s = dict(masters), due_s, self_test_s
        self._crc = loaded.provenance.config_crc
        self.use(loaded)

    def use(self, loaded: Loaded) -> None:
        """Another recipe is in use."""
        reference = loaded.inspector.reference
        self._drift_watch = None if reference is None else DriftWatch(reference)
        self.drift: Drift | None = None
        """As of the last judged part; None if it is not watched."""
        self._self_test = loaded.self_test
        self.self_test_failed = False
        self._tested_s = time.monotonic()
        crc = loaded.provenance.config_crc
        if crc != self._crc:  # what was right by other limits proves nothing; what was wrong stays so
            self._masters = {
                s: m if m.found not in (None, m.expected) else Master(m.expected)
                for s, m in self._masters.items()
            }
        self._crc = crc

    @property
    def drifting(self) -> bool:
        """Whether the pictures have changed."""
        return self.drift is not None and self.drift.alarm

    @property
    def trusted(self) -> bool:
        """Whether an OK may be said: no master was judged wrongly, the self-test passes."""
        return not self.master_wrong and not self.self_test_failed

    @property
    def master_wrong(self) -> bool:
        """Whether a master was judged wrongly and not yet right again."""
        return any(m.found not in (None, m.expected) for m in self._masters.values())

    @property
    def masters_due(self) -> bool:
        """Whether a master was not judged for too long."""
        return self._due_s is not None and any(
            time.time() - m.checked_s > self._due_s for m in self._masters.values()
        )

    def part(self, inspection: Inspection) -> None:
        """A part was judged."""
        self._tested_s = time.monotonic()
        if self._drift_watch is None or not inspection.look:
            return
        before, self.drift = self.drifting, self._drift_watch.part(np.array(inspection.look))
        if self.drifting and not before:
            log.warning(
                "the pictures drift (%.2f, limit %.2f); check light, focus and surface",
                self.drift.value,
                self.drift.limit,
            )
        elif before and not self.drifting:
            log.info("the pictures are as they were (%.2f)", self.drift.value)

    def master(self, serial: str, found: Verdict) -> None:
        """A master was judged."""
        master = self._masters.get(serial)
        if master is None:
            log.warning("golden check: serial %r is no master; name it under golden.masters", serial)
            return
        self._masters[serial] = Master(master.expected, found, time.time())
        if found is master.expected:
            log.info("golden check: master %s judged %s, right", serial, found)
        else:
            log.error(
                "golden check: master %s judged %s, must be %s; no verdict counts until it is right",
                serial,
                found,
                master.expected,
            )

    def idle(self) -> None:
        """No part is there: judge the stored frame if it is time."""
        wait_s = AGAIN_S if self.self_test_failed else self._self_test_s
        if self._self_test is None or time.monotonic() - self._tested_s < wait_s:
            return
        try:
            failed = not self._self_test.passes()
        except Exception:
            log.exception("the self-test ended with a fault")
            failed = True
        self._tested_s = time.monotonic()
        if failed and not self.self_test_failed:
            log.error(
                "self-test failed: the stored frame is judged differently; restart the station, check the PC's memory"
            )
        elif self.self_test_failed and not failed:
            log.info("self-test passed again")
        self.self_test_failed = failed
