"""Two ring networks combined in one file.

One may be precise but blind to some surfaces, the other see more of them, less precisely. Their offsets are
weighted by presence, the first network's three times; the presences are averaged.
"""

import json
from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, compose, helper

from models.classifier.export import keep, largest_gap, save
from station.classify.onnx import RingNetwork
from station.vision.polar import COLUMNS, ROWS, SECTORS

FIRST_WEIGHT = 3.0


def pair_rings(first: Path, second: Path, out: Path, version: str) -> None:
    """Write ring.onnx and RING.md into `out`.

    Raises ModelError, or LearningError if the file does not answer as the two networks together.
    """
    networks = [RingNetwork(path) for path in (first, second)]
    loaded = [onnx.load(str(path)) for path in (first, second)]
    parents = [{m.key: m.value for m in model.metadata_props} for model in loaded]
    hashes = [parent.get("weldgate.data_hash", "unknown") for parent in parents]
    out.mkdir(parents=True, exist_ok=True)
    part = out / "ring.part.onnx"
    metadata = {"weldgate.version": version, "weldgate.data_hash": "+".join(hashes)}
    save(_paired(*loaded), part, metadata)
    band = np.random.default_rng(0).integers(0, 256, (ROWS, COLUMNS), dtype=np.uint8)[None]
    (o1, p1), (o2, p2) = (network.sectors(band)[0] for network in networks)
    weight = FIRST_WEIGHT * p1
    expected = np.stack([(weight * o1 + p2 * o2) / (weight + p2 + 1e-6), (p1 + p2) / 2])
    keep(part, out / "ring.onnx", largest_gap(expected, RingNetwork(part).sectors(band)[0]))
    facts = [
        {"version": parent.get("weldgate.version"), "data_hash": data_hash, "sha256": network.file_hash}
        for parent, data_hash, network in zip(parents, hashes, networks, strict=True)
    ]
    card = {"version": version, "first_weight": FIRST_WEIGHT, "networks": facts}
    (out / "RING.md").write_text(
        "# Ring network\n\n"
        "Two networks trained on rendered images only, joined by `weldgate-models pair-rings`.\n\n"
        f"```json\n{json.dumps(card, indent=2)}\n```\n"
    )


def _paired(first: onnx.ModelProto, second: onnx.ModelProto) -> onnx.ModelProto:
    a, b = (
        compose.add_prefix(model, f"{name}/", rename_inputs=False)
        for name, model in (("a", first), ("b", second))
    )
    values = [
        helper.make_tensor(name, TensorProto.FLOAT, [1], [value])
        for name, value in (("w", FIRST_WEIGHT), ("half", 0.5), ("e", 1e-6))
    ]
    target = helper.make_tensor_value_info("sectors", TensorProto.FLOAT, ["count", 2, SECTORS])
    graph = helper.make_graph(
        [*a.graph.node, *b.graph.node, *_mean()],
        "rings",
        list(a.graph.input),
        [target],
        [*a.graph.initializer, *b.graph.initializer, *values],
    )
    return helper.make_model(graph, opset_imports=list(a.opset_import), ir_version=a.ir_version)


def _mean() -> list[onnx.NodeProto]:
    """Return the nodes that average the sectors of `a` and `b`, each (K, 2, 84) of offset and presence."""
    return [
        helper.make_node("Split", ["a/sectors"], ["o1", "p1"], axis=1),
        helper.make_node("Split", ["b/sectors"], ["o2", "p2"], axis=1),
        helper.make_node("Mul", ["p1", "w"], ["w1"]),
        helper.make_node("Mul", ["w1", "o1"], ["s1"]),
        helper.make_node("Mul", ["p2", "o2"], ["s2"]),
        helper.make_node("Add", ["s1", "s2"], ["s"]),
        helper.make_node("Add", ["w1", "p2"], ["w12"]),
        helper.make_node("Add", ["w12", "e"], ["whole"]),
        helper.make_node("Div", ["s", "whole"], ["offset"]),
        helper.make_node("Add", ["p1", "p2"], ["p12"]),
        helper.make_node("Mul", ["p12", "half"], ["presence"]),
        helper.make_node("Concat", ["offset", "presence"], ["sectors"], axis=1),
    ]
