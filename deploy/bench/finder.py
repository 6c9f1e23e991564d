"""Compares the time of finding the ring with that of plain OpenCV on a whole frame, in turns."""

import argparse
import statistics
from collections.abc import Callable
from time import perf_counter

import cv2
from rich.console import Console
from rich.table import Table

from deploy.demo.station import shipped_parts
from station.classify.onnx import RingNetwork
from station.domain import Image
from station.files.image import read_image
from station.files.installation import SHIPPED_NETWORKS
from station.numbers import whole_option
from station.vision.locate import Expected, locate
from station.vision.reduced import reduce_to_finder

THREADS = 2
UM_PER_PX = 13.0
STRIP = (128, 2688)
"""Height and width of the strip that plain OpenCV unwraps."""


def plain_opencv(image: Image) -> bool:
    """Look for the weld by the Hough transform at half size, unwrap it, and return whether there was one."""
    half = cv2.resize(image, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    expected = Expected()
    low, high = (
        round((expected.radius_mm + side * expected.tolerance_mm) * 500 / UM_PER_PX) for side in (-1, 1)
    )
    circles = cv2.HoughCircles(
        half,
        cv2.HOUGH_GRADIENT,
        dp=2,
        minDist=half.shape[0],
        param1=100,
        param2=30,
        minRadius=low,
        maxRadius=high,
    )
    if circles is None:
        return False
    x, y, radius = (2 * float(value) for value in circles.reshape(-1, 3)[0])
    reach = radius + STRIP[0] / 2
    cv2.warpPolar(image, (round(reach), STRIP[1]), (x, y), reach, cv2.WARP_POLAR_LINEAR)
    return True


def main() -> None:
    """Measure in turns and print medians and ratios."""
    parser = argparse.ArgumentParser(prog="python -m deploy.bench.finder", description=__doc__)
    parser.add_argument(
        "--rounds", type=whole_option, default=50, metavar="N", help="number of turns (default: %(default)s)"
    )
    rounds = parser.parse_args().rounds
    if rounds < 1:
        parser.error("--rounds must be at least 1")
    cv2.setNumThreads(THREADS)
    network = RingNetwork(SHIPPED_NETWORKS / "ring.onnx", THREADS)
    images = [read_image(part.path) for part in shipped_parts()]
    reduced = [reduce_to_finder(image, UM_PER_PX).image for image in images]
    runs: dict[str, Callable[[int], object]] = {
        "plain OpenCV: half size, Hough, warpPolar": lambda index: plain_opencv(images[index]),
        "locate": lambda index: locate(images[index], Expected(), network, um_per_px=UM_PER_PX),
        "  of it: frame to 52 µm/px": lambda index: reduce_to_finder(images[index], UM_PER_PX),
        "  of it: network": lambda index: network(reduced[index]),
    }
    times: dict[str, list[float]] = {name: [] for name in runs}
    for turn in range(rounds):
        for name, run in runs.items():
            start = perf_counter()
            run(turn % len(images))
            times[name].append((perf_counter() - start) * 1000)
    first = statistics.median(next(iter(times.values())))
    height, width = images[0].shape
    title = f"{width} x {height} px, {THREADS} threads, median of {rounds} in turns"
    table = Table("step", "median ms", "fastest ms", "plain / this", title=title)
    for name, values in times.items():
        median = statistics.median(values)
        table.add_row(name, f"{median:.1f}", f"{min(values):.1f}", f"{first / median:.1f}")
    Console().print(table)


if __name__ == "__main__":
    main()
