"""What else lies on a part: other circles, dirt, scratches, codes, tint, spatter, other welds."""

import cv2
import numpy as np

from synth.heightfield.grid import Field, noise, smooth_step
from synth.heightfield.sheets import Joint
from synth.heightfield.surface import Place, Surface
from synth.part.ranges import log_uniform, uniform


def add_circles(rng: np.random.Generator, surface: Surface, joint: Joint, *, keep_off_mm: float) -> None:
    """Add bores, grooves, steps, clamp rings and spots, not within `keep_off_mm` of the joint's circle."""
    for _ in range(int(rng.integers(0, 5))):
        concentric = rng.random() < 0.7
        x = joint.x_mm + rng.normal() * (0.15 if concentric else 6)
        y = joint.y_mm + rng.normal() * (0.15 if concentric else 6)
        radius = log_uniform(rng, (0.6, 13))
        width = log_uniform(rng, (0.04, 0.9))
        if concentric and abs(radius - joint.radius_mm) < keep_off_mm + width:
            continue
        away = np.hypot(surface.x_mm - np.float32(x), surface.y_mm - np.float32(y)) - np.float32(radius)
        free = smooth_step(np.abs(_from_joint(surface, joint)), keep_off_mm, keep_off_mm + 0.05)
        _circle(
            rng,
            surface,
            away,
            free,
            width=width,
            kind=str(rng.choice(["groove", "band", "bore", "step", "ridge"])),
        )


def _circle(
    rng: np.random.Generator, surface: Surface, away: Field, free: Field, *, width: float, kind: str
) -> None:
    line = (1 - smooth_step(np.abs(away), 0.3 * width, 0.5 * width + surface.cell_mm)) * free
    if kind == "groove":
        surface.height_mm -= line * np.float32(log_uniform(rng, (0.01, 0.2)))
        surface.blend(line, reflectance=uniform(rng, (0.03, 0.6)))
    elif kind == "ridge":
        surface.height_mm += line * np.float32(log_uniform(rng, (0.005, 0.06)))
    elif kind == "band":  # burnished by a clamp, or matt
        surface.blend(line, reflectance=uniform(rng, (0.3, 1.0)), roughness=log_uniform(rng, (0.07, 0.45)))
    elif kind == "bore":
        inside = smooth_step(-away, -surface.cell_mm, surface.cell_mm) * free
        if float(inside.mean()) < 0.12:
            surface.height_mm -= inside * np.float32(0.3)
            surface.blend(inside, reflectance=uniform(rng, (0.0, 0.15)))
    else:
        inside = smooth_step(-away, -0.03, 0.03) * free
        surface.height_mm += inside * np.float32(uniform(rng, (-0.15, 0.15)))


def add_spot(rng: np.random.Generator, surface: Surface, x: float, y: float) -> None:
    """Add a resistance spot weld: a dent with a rim, dark halo and burnished middle. It is not a bead."""
    radius = log_uniform(rng, (1.0, 5.0))
    rho = np.hypot(surface.x_mm - np.float32(x), surface.y_mm - np.float32(y)) / np.float32(radius)
    rho = rho + np.float32(uniform(rng, (0, 0.08))) * noise(rng, surface.x_mm, surface.y_mm, (2.0, 2.0))
    dent = np.float32(uniform(rng, (0.02, 0.25)))
    surface.height_mm -= dent * (1 - smooth_step(rho, uniform(rng, (0.3, 0.75)), 0.95))
    surface.height_mm += np.float32(uniform(rng, (0, 0.04))) * np.exp(-(((rho - 1.0) / 0.08) ** 2))
    halo = np.exp(-(((rho - uniform(rng, (0.8, 1.05))) / uniform(rng, (0.06, 0.25))) ** 2))
    surface.blend(
        np.asarray(halo * np.float32(uniform(rng, (0.3, 0.95))), np.float32),
        reflectance=uniform(rng, (0.02, 0.3)),
    )
    middle = 1 - smooth_step(rho, 0.4, 0.7)
    surface.blend(
        middle * np.float32(uniform(rng, (0, 1))),
        roughness=log_uniform(rng, (0.07, 0.4)),
        reflectance=uniform(rng, (0.3, 1)),
    )


def add_dirt(rng: np.random.Generator, surface: Surface, joint: Joint, half_width_mm: float) -> None:
    """Add tint and plume beside the bead, spatter, dust, stains of oil, scratches, fibres and codes."""
    outside = np.maximum(np.abs(_from_joint(surface, joint)) - np.float32(half_width_mm), 0)
    sheet = (surface.place == Place.OTHER).astype(np.float32)
    if rng.random() < 0.4:  # heat tint: rings of interference
        reach = log_uniform(rng, (0.1, 1.5))
        rings = 0.7 + 0.3 * np.cos(outside / np.float32(reach) * np.float32(uniform(rng, (3, 12))))
        patchy = np.clip(0.8 + 0.3 * noise(rng, surface.x_mm, surface.y_mm, (1.5, 1.5)), 0, 1)
        surface.reflectance *= (
            1
            - np.float32(uniform(rng, (0.1, 0.7)))
            * np.exp(-((outside / np.float32(reach)) ** 2))
            * rings
            * patchy
            * sheet
        )
    if rng.random() < 0.4:  # plume
        reach = log_uniform(rng, (0.3, 4))
        cloud = noise(rng, surface.x_mm, surface.y_mm, (2.0, 2.0)) + 0.4 * noise(
            rng, surface.x_mm, surface.y_mm, (0.3, 0.3)
        )
        soot = (
            np.clip(0.4 + 0.5 * cloud, 0, 1)
            * np.exp(-outside / np.float32(reach))
            * np.float32(uniform(rng, (0.1, 0.8)))
        )
        surface.blend(
            np.asarray(soot * (0.3 + 0.7 * sheet), np.float32),
            reflectance=uniform(rng, (0.02, 0.3)),
            roughness=0.4,
        )
    if rng.random() < 0.3:  # oil
        cloud = noise(rng, surface.x_mm, surface.y_mm, (3.0, 3.0))
        low = uniform(rng, (0.5, 1.5))
        surface.blend(
            smooth_step(cloud, low, low + 0.2) * np.float32(0.6), roughness=log_uniform(rng, (0.06, 0.2))
        )
    _spatter(rng, surface)
    _lines(rng, surface)
    if rng.random() < 0.15:
        _data_matrix(rng, surface, outside)


def add_tack(
    rng: np.random.Generator,
    surface: Surface,
    joint: Joint,
    half_width_mm: float,
    *,
    apart: tuple[float, float] = (1.2, 6),
) -> None:
    """Add a short straight weld beside the ring, as of a tab. It is a bead, but not the ring's.

    `apart` is the range of its distance from the joint, in half-widths.
    """
    angle = uniform(rng, (0, 2 * np.pi))
    away = joint.radius_mm + half_width_mm * uniform(rng, apart)
    u_mm = (surface.x_mm - np.float32(joint.x_mm)) * np.float32(np.cos(angle)) + (
        surface.y_mm - np.float32(joint.y_mm)
    ) * np.float32(np.sin(angle))
    v_mm = -(surface.x_mm - np.float32(joint.x_mm)) * np.float32(np.sin(angle)) + (
        surface.y_mm - np.float32(joint.y_mm)
    ) * np.float32(np.cos(angle))
    across = (u_mm - np.float32(away)) / np.float32(half_width_mm * uniform(rng, (0.7, 1.2)))
    length = uniform(rng, (1, 6))
    inside = (1 - smooth_step(np.abs(across), 0.9, 1.05)) * (
        1 - smooth_step(np.abs(v_mm), length, length + 0.1)
    )
    inside *= surface.place == Place.OTHER
    pitch = log_uniform(rng, (0.1, 0.5))
    ripple = np.cos(2 * np.pi * (v_mm + np.float32(half_width_mm) * across * across) / np.float32(pitch))
    surface.height_mm += np.asarray(
        inside
        * (
            uniform(rng, (-0.02, 0.08)) * (1 - np.minimum(np.abs(across), 1) ** 2)
            + log_uniform(rng, (0.001, 0.01)) * ripple
        ),
        np.float32,
    )
    surface.blend(
        np.asarray(inside, np.float32),
        reflectance=uniform(rng, (0.3, 1.0)),
        roughness=log_uniform(rng, (0.08, 0.4)),
    )
    surface.place[inside > 0.5] = Place.BEAD


def add_edge(rng: np.random.Generator, surface: Surface, joint: Joint, *, reach_mm: float) -> None:
    """Add an edge of the part beside the ring; beyond it lies the dark, blurred ground."""
    angle = uniform(rng, (0, 2 * np.pi))
    away = joint.radius_mm + reach_mm + log_uniform(rng, (0.2, 5))
    u_mm = (surface.x_mm - np.float32(joint.x_mm)) * np.float32(np.cos(angle))
    v_mm = (surface.y_mm - np.float32(joint.y_mm)) * np.float32(np.sin(angle))
    beyond = smooth_step(u_mm + v_mm, away, away + log_uniform(rng, (0.03, 1.5)))
    surface.blend(beyond, reflectance=uniform(rng, (0.0, 0.5)), roughness=0.45)
    surface.height_mm -= beyond * np.float32(uniform(rng, (0, 0.5)))


def _from_joint(surface: Surface, joint: Joint) -> Field:
    return np.asarray(
        np.hypot(surface.x_mm - np.float32(joint.x_mm), surface.y_mm - np.float32(joint.y_mm))
        - np.float32(joint.radius_mm)
    )


def _spatter(rng: np.random.Generator, surface: Surface) -> None:
    """Add balls and specks: each is drawn in its own small window."""
    side = surface.height_mm.shape[0]
    count = int(log_uniform(rng, (1, 60))) if rng.random() < 0.7 else 0
    for _ in range(count):
        radius = log_uniform(rng, (0.015, 0.09)) / surface.cell_mm
        row, column = rng.integers(0, side, 2)
        reach = int(np.ceil(radius)) + 1
        rows, columns = (
            slice(max(row - reach, 0), row + reach + 1),
            slice(max(column - reach, 0), column + reach + 1),
        )
        y, x = np.ogrid[rows.start : min(rows.stop, side), columns.start : min(columns.stop, side)]
        rho = np.hypot(y - row, x - column) / radius
        dome = np.sqrt(np.maximum(1 - rho**2, 0)).astype(np.float32)
        if rng.random() < 0.6:
            surface.height_mm[rows, columns] += dome * np.float32(
                radius * surface.cell_mm * uniform(rng, (0.2, 0.9))
            )
        spot = surface.reflectance[rows, columns]
        spot += (rho < 1) * np.float32(uniform(rng, (0, 1))) * (np.float32(uniform(rng, (0.02, 0.8))) - spot)


def _lines(rng: np.random.Generator, surface: Surface) -> None:
    """Add scratches and fibres."""
    side = surface.height_mm.shape[0]
    for _ in range(int(rng.integers(0, 10))):
        steps = np.linspace(0, 1, 30)[:, None]
        heading = uniform(rng, (0, 2 * np.pi)) + uniform(rng, (-1.2, 1.2)) * steps
        length = log_uniform(rng, (0.5, 10)) / surface.cell_mm
        points = (
            rng.uniform(0, side, 2)
            + length * np.cumsum(np.hstack([np.cos(heading), np.sin(heading)]), axis=0) / 30
        )
        line = np.zeros(surface.height_mm.shape, np.uint8)
        cv2.polylines(
            line,
            [np.round(points * 16).astype(np.int32)],
            False,
            255,
            max(1, round(0.02 / surface.cell_mm)),
            cv2.LINE_AA,
            4,
        )
        rows, columns = np.nonzero(line)
        weight = line[rows, columns].astype(np.float32) / 255 * np.float32(uniform(rng, (0.3, 1)))
        surface.reflectance[rows, columns] += weight * (
            np.float32(uniform(rng, (0.05, 1.0))) - surface.reflectance[rows, columns]
        )
        surface.height_mm[rows, columns] += weight * np.float32(rng.normal() * 0.004)


def _data_matrix(rng: np.random.Generator, surface: Surface, outside: Field) -> None:
    """Add a square code of dark cells away from the weld."""
    side = surface.height_mm.shape[0]
    cells, pitch = int(rng.integers(10, 25)), log_uniform(rng, (0.08, 0.3)) / surface.cell_mm
    size = int(cells * pitch)
    if size + 2 >= side:
        return
    row, column = rng.integers(0, side - size, 2)
    bits = (rng.random((cells, cells)) < 0.5).astype(np.float32)
    bits[:, 0] = bits[-1] = 1
    code = cv2.resize(bits, (size, size), interpolation=cv2.INTER_NEAREST)
    area = (slice(row, row + size), slice(column, column + size))
    weight = code * np.float32(uniform(rng, (0.3, 0.95))) * (outside[area] > 0.2)
    surface.reflectance[area] += weight * (np.float32(uniform(rng, (0.02, 1.0))) - surface.reflectance[area])
