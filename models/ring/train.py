"""Training of the ring network on rendered pictures; a run that was stopped is resumed."""

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from itertools import islice
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from models.classifier.network import channels_last
from models.ring.network import RingNet, cells_of
from models.ring.pictures import Picture
from models.ring.samples import Sample, chances, sample

REPORT_STEPS = 100
"""Number of steps between two reports, after each of which the run can be resumed."""
AHEAD = 3
"""Number of batches that are drawn ahead."""
CHECKPOINT = "ring.resume.pt"
"""Name of the file from which a run is resumed."""

Report = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class RingPlan:
    """How to train."""

    steps: int = 9000
    batch: int = 8
    learning_rate: float = 0.01
    seed: int = 0


def train_ring(pictures: Sequence[Picture], plan: RingPlan, out: Path, report: Report) -> RingNet:
    """Train on pictures and return the network, ready to be used.

    Every hundred steps the state is written into `out`; a run with the same plan and pictures goes from
    there, and ends with the same network as one that was not stopped.
    """
    torch.manual_seed(plan.seed)
    network = RingNet()
    channels_last(network)
    optimizer = torch.optim.AdamW(network.parameters(), lr=plan.learning_rate, weight_decay=0.02)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, plan.learning_rate, total_steps=plan.steps)
    path, key = out / CHECKPOINT, _key(pictures, plan)
    done = _resume(path, key, (network, optimizer, schedule))
    if done:
        report(f"resumed after step {done}")
    network.train()
    running = 0.0
    for step, (images, coverage) in enumerate(_batches(pictures, plan, done), done + 1):
        with torch.autocast("cpu", torch.bfloat16):
            logits = network(images.to(memory_format=torch.channels_last))
        loss = _loss(logits.float(), coverage)
        optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        optimizer.step()
        schedule.step()
        running += float(loss.detach())
        if step % REPORT_STEPS == 0 or step == plan.steps:
            _keep(path, key, step, (network, optimizer, schedule))
            report(f"step {step}/{plan.steps}: loss {running / ((step - 1) % REPORT_STEPS + 1):.4f}")
            running = 0.0
    return network.eval()


def _batches(pictures: Sequence[Picture], plan: RingPlan, done: int) -> Iterator[tuple[Tensor, Tensor]]:
    """Yield images (K, 1, N, N) uint8 and covered fractions (K, 8, N / 4, N / 4) of the steps after `done`.

    Each step has its own stream of random numbers, so that a resumed run sees what it would have seen.
    """

    chance = chances(pictures)

    def draw(step: int) -> list[Sample]:
        rng = np.random.default_rng([plan.seed, step])
        return [sample(pictures, chance, rng) for _ in range(plan.batch)]

    with ThreadPoolExecutor(1) as pool:
        steps = iter(range(done, plan.steps))
        ahead = [pool.submit(draw, step) for step in islice(steps, AHEAD)]
        while ahead:
            drawn = ahead.pop(0).result()
            ahead += [pool.submit(draw, step) for step in islice(steps, 1)]
            images = torch.from_numpy(np.stack([one.image for one in drawn])[:, None])
            yield images, cells_of(torch.from_numpy(np.stack([one.coverage for one in drawn])))


def _loss(logits: Tensor, coverage: Tensor) -> Tensor:
    """Return cross entropy plus what is lacking in the overlap of bead and of joint."""
    entropy = functional.binary_cross_entropy_with_logits(logits, coverage)
    pairs = zip(torch.sigmoid(logits).chunk(2, dim=1), coverage.chunk(2, dim=1), strict=True)
    overlaps = [
        2 * (found * true).sum() / ((found * found).sum() + (true * true).sum() + 1.0)
        for found, true in pairs
    ]
    return 4 * entropy + (2 - overlaps[0] - overlaps[1]) / 2


Parts = tuple[RingNet, torch.optim.Optimizer, torch.optim.lr_scheduler.LRScheduler]


def _key(pictures: Sequence[Picture], plan: RingPlan) -> str:
    """Return a hash of all that decides how a run goes."""
    digest = hashlib.sha256(json.dumps(asdict(plan)).encode())
    for picture in pictures:
        digest.update(picture.image.tobytes() + picture.masks.tobytes())
    return digest.hexdigest()


def _resume(path: Path, key: str, parts: Parts) -> int:
    """Restore the state of a stopped run and return its number of steps; 0 if there is none of this key."""
    if not path.is_file():
        return 0
    state = torch.load(path, weights_only=True)
    if state["key"] != key:
        return 0
    network, optimizer, schedule = parts
    network.load_state_dict(state["parts"][0])
    optimizer.load_state_dict(state["parts"][1])
    schedule.load_state_dict(state["parts"][2])
    return int(state["step"])


def _keep(path: Path, key: str, step: int, parts: Parts) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    torch.save({"key": key, "step": step, "parts": [one.state_dict() for one in parts]}, part)
    os.replace(part, path)
