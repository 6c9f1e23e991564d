"""The drawing of a part: every signal has its lane, and an edge lies where its time says."""

import re

import pytest

from deploy.bench.plc_part import Bus, measure
from deploy.bench.signals import LANES, drawn
from station.plc.bus_log import Edge


def test_an_edge_lies_at_its_time() -> None:
    seen = [(10.0, Edge("", "PLC", "TRIGGER", 1)), (10.1, Edge("", "PLC", "TRIGGER", 0))]
    seen.append((10.2, Edge("", "station", "VERDICT", "OK")))
    drawing = drawn(seen, LANES, "poll <20> ms")
    assert "poll &lt;20&gt; ms" in drawing
    assert [name in drawing for _, name in LANES] == [True] * len(LANES)
    path = re.findall(r'd="(M [^"]+)" class="plc"', drawing)[1]
    rise, fall = (float(at) for at in re.findall(r"H ([\d.]+) V", path))
    marks = [float(at) for at in re.findall(r'<line x1="([\d.]+)"', drawing)]
    assert (rise, fall) == pytest.approx((marks[0], marks[2]), abs=0.2), "0 and 100 ms, a mark each 50 ms"
    with pytest.raises(ValueError, match="no edge"):
        drawn([], LANES, "")


@pytest.mark.parametrize("mode", ["server", "client"])
def test_a_part_is_measured_with_all_its_edges(mode: str) -> None:
    bus = Bus()
    assert len(measure(mode, 20, 2, bus)) == 2
    names = [edge.name for _, edge in bus.seen]
    order = [names.index(name) for name in ("TRIGGER", "BUSY", "RESULT_VALID", "RESULT_ACK")]
    assert order == sorted(order)
