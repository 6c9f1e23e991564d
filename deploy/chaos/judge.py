"""Stands in for the inspection where only the line is looked at: answers triggers in a thread, as the cycle would."""

import threading
from collections.abc import Callable

from station.domain import SEGMENTS
from station.plc.map.registers import Flags, Offline, VerdictCode
from station.plc.port import Health, Line, Result, Trigger

WELL = Health(ready=True, offline=Offline.NONE, failure=False, config_crc=4711)


def judged(trigger: Trigger, verdict: VerdictCode, inspection_id: int | None = None) -> Result:
    """Make up a result with low scores; its inspection number is that of the trigger if none is given."""
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
    """Runs between `with` and its end; `decide` gives the result of a trigger, which is offered at once."""

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
            self._line.checked_in(WELL)
            request = self._line.next_request(0.05)
            if isinstance(request, Trigger) and self._line.in_work(request):
                self._line.exposure_done(request)
                self._line.publish(self._decide(request))
