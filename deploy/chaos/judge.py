"""A judge replaces the inspection in tests of the line: it answers triggers in a thread, like the cycle."""

import threading
from collections.abc import Callable

from station.domain import SEGMENTS
from station.plc.map.registers import Flags, Offline, VerdictCode
from station.plc.port import Health, Line, Result, Trigger

WELL = Health(ready=True, offline=Offline.NONE, failure=False, config_crc=4711)
"""Health of a station that works."""


def judged(trigger: Trigger, verdict: VerdictCode, inspection_id: int | None = None) -> Result:
    """Return a result with low scores; by default its inspection number is the number of the trigger."""
    return Result(
        trigger=trigger,
        verdict=verdict,
        inspection_id=trigger.number if inspection_id is None else inspection_id,
        reason=0,
        error_code=0,
        seg_scores=(5,) * SEGMENTS,
        seg_nok_mask=0,
        seg_invalid_mask=0,
        flags=Flags(0),
    )


class Judge:
    """Context manager that answers each trigger with the result of `decide`."""

    def __init__(self, line: Line, decide: Callable[[Trigger], Result]) -> None:
        self._line, self._decide = line, decide
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="judge")

    def __enter__(self) -> "Judge":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join(timeout=10)

    def _run(self) -> None:
        while not self._stop.is_set():
            self._line.check_in(WELL)
            request = self._line.next_request(0.05)
            if isinstance(request, Trigger) and self._line.awaits_result(request):
                self._line.exposure_done(request)
                self._line.publish(self._decide(request))
