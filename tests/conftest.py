"""Guards: emulated camera, offscreen window, single threads, and nothing left running after a test."""

import os

os.environ["PYLON_CAMEMU"] = "1"
os.environ["QT_QPA_PLATFORM"] = "offscreen"
# threads that spin for each other multiply the time on a machine that is busy
os.environ["OMP_NUM_THREADS"] = "1"
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

from station.domain import Image
from station.files.image import read_image
from station.settings.model import ModelSettings
from tests.parts import FRAMES, labels

# a deadline of hypothesis is a speed test, which a busy machine fails
settings.register_profile("weldgate", deadline=None)
settings.load_profile("weldgate")

ROOT = Path(__file__).resolve().parent.parent
RING_MODEL = ROOT / "models" / "shipped" / "ring.onnx"
SEEN_MODEL = ROOT / "models" / "shipped" / "seen.onnx"
MODEL = ROOT / "models" / "shipped" / "weldgate.onnx"
NETWORKS = ModelSettings(path=MODEL, ring_path=RING_MODEL, seen_path=SEEN_MODEL)
"""The shipped networks."""


@pytest.fixture(autouse=True)
def _nothing_left_running() -> Iterator[None]:
    before = set(threading.enumerate())
    yield
    left = [t for t in threading.enumerate() if t not in before and t.is_alive()]
    for thread in left:
        thread.join(timeout=2)
    assert not [t.name for t in left if t.is_alive()]


@pytest.fixture(scope="session")
def frames() -> dict[str, Image]:
    """The shipped frames by name."""
    return {item["frame"]: read_image(FRAMES / item["frame"]) for item in labels()}


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(0)
