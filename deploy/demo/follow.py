"""`weldgate-demo --station --preset`: the station alone, as client of a PLC that is the Modbus server.

Such a PLC may allow one connection only, so what happens is read from the station's own bus log.
"""

import itertools
import time
from pathlib import Path

from rich.console import Console

from deploy.demo.stage import Stage
from deploy.demo.station import shipped_parts
from station.errors import RecordError
from station.plc.bus_log import tail_bus
from station.plc.map.registers import VerdictCode

POLL_S = 0.05
MOST_EDGES = 10_000
"""Number of edges that are taken in at once."""


def follow_bus(stage: Stage, records: Path, console: Console) -> None:
    """Show a new part at each trigger until interrupted. Raises WeldgateError if the engine stops."""
    parts = itertools.cycle(shipped_parts())
    lying = in_work = next(parts)
    stage.show(lying)
    trigger: int | str = 0
    place = _end(records)
    while True:
        stage.check()
        found, place = tail_bus(records, place, MOST_EDGES) if records.is_dir() else ([], place)
        for edge in found:
            if edge.name == "ACK_TRIGGER_ID":
                trigger = edge.value
            elif edge.name == "EXPOSURE_DONE" and edge.value:
                in_work, lying = lying, next(parts)
                stage.show(lying)
            elif edge.name == "VERDICT" and edge.value != VerdictCode.NONE.name:
                console.print(f"trigger {trigger:>5}  {edge.value:5}  truth {in_work.truth}", highlight=False)
        time.sleep(POLL_S)


def _end(records: Path) -> tuple[str, int]:
    """Return the place after what a station before has logged."""
    try:
        return tail_bus(records, ("", 0), 1)[1]
    except RecordError:
        return "", 0
