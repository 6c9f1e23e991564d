"""An artificial surface measurement of a weld, in place of a real one; made by a method of its own.

Each laser pulse leaves a lens of melt that freezes over the lenses before it, as in a pulsed seam weld; of
each, only what the later ones leave uncovered can be seen. Partner step, tilt, noise and lost points are
those of a white-light interferometer. `weldgate-synth artificial` writes the shipped file again, byte for
byte.
"""

import hashlib
import zipfile
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from station.files.durable import replacing
from synth.part.streams import Stream, stream

STEP_UM = 3.0
"""Distance between two points of the map."""
SIZE = 2000
"""Points on each side of the map."""
HEIGHT_STEP_UM = 0.05
"""Resolution of the heights in the file."""
NOTE = (
    "MADE, NOT MEASURED: an artificial surface (overlapping frozen melt pools, partner step, noise, "
    "lost points) in place of a white-light interferometer measurement of a real weld"
)

Array = NDArray[np.float64]


def write_artificial(path: Path, seed: int) -> None:
    """Write the artificial measurement of a seed as x3p; the shipped one is that of seed 1."""
    write_x3p(path, *make_weld(seed), step_um=STEP_UM, note=NOTE)


def make_weld(seed: int) -> tuple[Array, NDArray[np.bool_]]:
    """Return heights (2000, 2000) in um, rows across the weld, and which of them are valid."""
    rng = stream(seed, Stream.ARTIFICIAL_MEASUREMENT)
    x_mm = np.arange(SIZE) * STEP_UM / 1000
    y_mm = (np.arange(SIZE) - SIZE / 2) * STEP_UM / 1000
    half_mm, pitch_mm = 0.47, 0.155
    lathe = 0.6 * np.cumsum(rng.normal(size=SIZE)) / 40
    lathe += 0.25 * np.sin(2 * np.pi * x_mm / 0.11 + rng.normal(size=SIZE) * 0.1)
    z = np.broadcast_to(lathe[None, :], (SIZE, SIZE)).copy()
    z[y_mm > 0] += 14.0
    end_mm = float(x_mm[-1]) + 2.0
    for at in np.arange(-1.5, end_mm, pitch_mm):
        place_mm = float(at) + 0.006 * float(rng.normal())
        width_mm, steep = half_mm * float(rng.normal(1, 0.012)), float(rng.normal(1, 0.12))
        _pulse(z, rng, x_mm=x_mm, y_mm=y_mm, at_mm=place_mm, half_mm=width_mm, steep=steep)
    slope = np.hypot(*np.gradient(cv2.GaussianBlur(z, (0, 0), 2), STEP_UM))
    lost = rng.random(z.shape) < 0.01 + 0.7 / (1.0 + np.exp(-(slope - 0.45) / 0.05))
    z += rng.normal(0, 0.12, z.shape)
    z += 0.8 * x_mm[None, :] - 1.3 * y_mm[:, None]
    return z, ~lost


def _pulse(
    z: Array,
    rng: np.random.Generator,
    *,
    x_mm: Array,
    y_mm: Array,
    at_mm: float,
    half_mm: float,
    steep: float,
) -> None:
    """Draw one frozen pool over those before it: rounded rear, ridge where it froze first, dip, crown."""
    columns = np.flatnonzero((x_mm > at_mm - 0.01) & (x_mm < at_mm + 1.4))
    rows = np.flatnonzero(np.abs(y_mm - 0.005) < half_mm)
    if columns.size == 0:
        return
    y = y_mm[rows][:, None] + 0.006 * float(rng.normal())
    q = np.clip(1 - (y / half_mm) ** 2, 0, 1)
    wave = sum(
        rng.normal() * np.sin(2 * np.pi * y / pitch + rng.uniform(0, 6.3))
        for pitch in (0.6, 0.31, 0.17, 0.09)
    )
    rear_mm = 0.36 * (1 - np.sqrt(q)) + 0.007 * wave
    behind = x_mm[columns][None, :] - at_mm - rear_mm
    inside = (behind >= 0) & (q > 0)
    along = np.clip(behind / 0.155, 0, 9)
    crown = 38.0 * q**0.8 * float(rng.normal(1, 0.012))
    ridge = float(rng.normal(16.0, 2.0)) * np.exp(-along / 0.45)
    ridge = ridge - 5.0 * np.exp(-(((along - 0.9) / 0.4) ** 2)) + 5.0 * along
    step = 7.0 * (1 + np.tanh(y / 0.2))
    grain = 0.5 * rng.normal(size=(rows.size // 12 + 2, columns.size // 12 + 2))
    fine = cv2.resize(grain, (columns.size, rows.size), interpolation=cv2.INTER_CUBIC)
    block = z[np.ix_(rows, columns)]
    z[np.ix_(rows, columns)] = np.where(inside, crown + step + (ridge * steep + fine) * np.sqrt(q), block)


def write_x3p(path: Path, height_um: Array, valid: NDArray[np.bool_], *, step_um: float, note: str) -> None:
    """Write an x3p file (ISO 25178-72): int16 heights, a mask of valid points, the note as its comment."""
    counts = np.where(valid, np.clip(np.round(height_um / HEIGHT_STEP_UM), -32768, 32767), 0).astype("<i2")
    data, mask = counts.tobytes(), np.packbits(valid.ravel(), bitorder="little").tobytes()
    record = _record(height_um.shape, step_um, note, data_md5=_md5(data), mask_md5=_md5(mask))
    members = {
        "main.xml": record.encode(),
        "bindata/data.bin": data,
        "bindata/valid.bin": mask,
        "md5checksum.hex": f"{_md5(record.encode()).lower()} *main.xml\n".encode(),
    }
    with (
        replacing(path) as part,
        zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive,
    ):
        for name, content in members.items():
            archive.writestr(zipfile.ZipInfo(name, (2026, 11, 22, 0, 0, 0)), content, zipfile.ZIP_DEFLATED, 9)


def _md5(content: bytes) -> str:
    return hashlib.md5(content).hexdigest().upper()


def _record(shape: tuple[int, ...], step_um: float, note: str, *, data_md5: str, mask_md5: str) -> str:
    """Return the description in the file."""
    rows, columns = shape
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2">',
        "<Record1><Revision>ISO5436 - 2000</Revision><FeatureType>SUR</FeatureType><Axes>",
        _axis("CX", "I", "D", step_um),
        _axis("CY", "I", "D", step_um),
        _axis("CZ", "A", "I", HEIGHT_STEP_UM),
        "</Axes></Record1>",
        "<Record2><Date>2026-11-22T00:00:00</Date><Creator>weldgate</Creator>",
        "<Instrument><Manufacturer>weldgate</Manufacturer><Model>made surface</Model>"
        "<Serial>none</Serial><Version>1</Version></Instrument>",
        "<CalibrationDate>2026-11-22T00:00:00</CalibrationDate>"
        "<ProbingSystem><Type>Software</Type><Identification>synth.made</Identification>",
        f"</ProbingSystem><Comment>{note}</Comment></Record2>",
        f"<Record3><MatrixDimension><SizeX>{columns}</SizeX><SizeY>{rows}</SizeY>"
        "<SizeZ>1</SizeZ></MatrixDimension>",
        "<DataLink><PointDataLink>bindata/data.bin</PointDataLink>"
        f"<MD5ChecksumPointData>{data_md5}</MD5ChecksumPointData>",
        "<ValidPointsLink>bindata/valid.bin</ValidPointsLink>"
        f"<MD5ChecksumValidPoints>{mask_md5}</MD5ChecksumValidPoints>",
        "</DataLink></Record3>",
        "<Record4><ChecksumFile>md5checksum.hex</ChecksumFile></Record4>",
        "</p:ISO5436_2>",
    ]
    return "".join(f"{line}\n" for line in lines)


def _axis(name: str, axis_type: str, data_type: str, step_um: float) -> str:
    return (
        f"<{name}><AxisType>{axis_type}</AxisType><DataType>{data_type}</DataType>"
        f"<Increment>{step_um * 1e-6:.9g}</Increment><Offset>0</Offset></{name}>"
    )
