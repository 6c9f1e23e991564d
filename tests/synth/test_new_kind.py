"""A new kind of defect needs its module and one line of the registry: everything else loops."""

import json
import subprocess
import sys
from pathlib import Path

import cv2
import pytest

from tests.conftest import ROOT

CODE = """
import json
import sys
from dataclasses import dataclass
from pathlib import Path
import station.defects
from station.defects import DefectKind, Reason, kind_named
dent = DefectKind(name="dent", reason=Reason.HOLE, color_rgb=(0, 0, 255), line_fraction=0.01)
seen = DefectKind(name="smear", reason=Reason.HOLE, color_rgb=(0, 0, 255), line_fraction=0.01,
                  is_mapped=False)
station.defects.KINDS = (kind_named("hole"), dent, seen, kind_named("missing_weld"))

from synth.defects import hole, kinds

@dataclass(frozen=True, slots=True)
class DentRanges(hole.HoleRanges):
    kind: str = "dent"
    def _named(self, drawn):
        dent = dataclass(frozen=True, slots=True)(type("Dent", (hole.Hole,), {"kind": self.kind}))
        return tuple(dent(*(getattr(d, f) for f in hole.Hole.__dataclass_fields__)) for d in drawn)
    def draw(self, rng, bead):
        return self._named(hole.HoleRanges.draw(self, rng, bead))
    def draw_on_piece(self, rng, bead):
        return self._named(hole.HoleRanges.draw_on_piece(self, rng, bead))
    def draw_on_ring(self, rng, bead, fraction):
        return self._named(hole.HoleRanges.draw_on_ring(self, rng, bead, fraction))

kinds.RANGES = {**kinds.RANGES, "dent": {"line": DentRanges(weight=0.5)},
                "smear": {"line": DentRanges(kind="smear")}}
from synth.__main__ import main
out, recipe = Path(sys.argv[1]), Path(sys.argv[1]) / "recipe.toml"
recipe.write_text("[dent]\\nweight = 1000.0\\nlength_mm = [0.5, 0.6]\\n")
from synth.output.dataset import Order, write_dataset
from synth.measured.measurement import SHIPPED, read_measurement
from synth.measured.spectrum import derive
from synth.part.switches import ALL
from synth.recipes.named import LINE
from synth.recipes.toml_file import read_recipe
model, changed = derive(read_measurement(SHIPPED)), read_recipe(recipe, LINE)
order = Order(seed=2, count=24, recipe=changed, switches=ALL, is_straight=True)
write_dataset(out / "set", order, model, executor=None, done=lambda n: None)
from synth.camera.optics import Optics
from synth.output.labels import label
from synth.output.lot import plan
from synth.part.part import draw_part
kinds_of_parts = [kind for _, kind in plan(1, 40, changed)]
assert kinds_of_parts.count("dent") > 35
part = draw_part(3, changed, kind="dent")
shown = label(part, Optics(), name="a", origin_px=(0, 0), size_px=(4200, 2160))
(out / "label.json").write_text(json.dumps(shown))
assert main(["sheet", str(out / "set"), "--out", str(out / "sheet.png")]) == 0
from synth.output.plan import plan_rings, quotas
crops = [c for shard in plan_rings(1, quotas(200), changed, ALL) for c in shard.crops]
assert sum(c.kind == "dent" for c in crops) == sum(c.kind == "smear" for c in crops) == 25
"""


@pytest.mark.render
def test_a_new_kind_is_planned_rendered_labelled_and_shown(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", CODE, str(tmp_path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    entries = json.loads((tmp_path / "set" / "manifest.json").read_text())["images"]
    by_kind = {kind: [e for e in entries if e["kind"] == kind] for kind in ("ok", "dent", "smear")}
    assert [len(found) for found in by_kind.values()] == [12, 3, 3]
    assert all(e["defects"][0]["kind"] == "dent" for e in by_kind["dent"])
    assert not any(e["defects"] for e in by_kind["smear"])  # judged by crop: no outline in the labels
    assert (tmp_path / "set" / "images" / "train" / "dent").is_dir()
    names = (tmp_path / "set" / "data.yaml").read_text().split("names:\n")[1]
    assert names == "  0: hole\n  1: dent\n  2: missing_weld\n"
    categories = json.loads((tmp_path / "set" / "coco_train.json").read_text())["categories"]
    assert [c["name"] for c in categories] == ["hole", "dent", "missing_weld"]
    label = json.loads((tmp_path / "label.json").read_text())
    assert label["truth"] == label["defects"][0]["kind"] == "dent"
    assert 0.5 <= label["defects"][0]["length_mm"] <= 0.6
    assert cv2.imread(str(tmp_path / "sheet.png")) is not None
