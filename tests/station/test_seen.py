"""OK is a positive finding: a segment that was not seen is never OK, whatever the network says of it."""

import re
from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.defects import KINDS, Reason
from station.domain import SEGMENT_DEG, SEGMENT_PX, SEGMENTS, Image, Inspection, Ring, Unseen, Verdict
from station.engine.plc_result import plc_result
from station.inspection.inspector import Inspector
from station.inspection.networks import Networks
from station.inspection.verdict import Novel, Novelty, decide
from station.plc.port import Trigger
from station.settings.model import ModelSettings, WeldSettings
from station.settings.quality import QualitySettings
from station.vision.locate import MIN_PRESENCE, Expected, locate
from station.vision.polar import SECTORS
from station.vision.seen import CHECKS, MIDDLE, causes, fine_structure, measure_segments, words
from tests.parts import label_with, ok_inspection, record, segment_quality

LIMITS = QualitySettings(min_segment_weld=0.25)
WELDED = np.ones(SECTORS)
FRACTION = st.floats(0, 1)
QUALITY = st.builds(
    replace,
    st.just(segment_quality()),
    mean_dn=st.floats(0, 255),
    dark_fraction=FRACTION,
    saturated_fraction=FRACTION,
    contrast=st.floats(0, 2),
    sharpness=st.floats(0, 2),
    fine_structure=st.floats(0, 2),
    weld=FRACTION,
    visible=st.none() | FRACTION,
)
QUALITIES = st.tuples(*[st.just(segment_quality()) | QUALITY] * SEGMENTS)
REJECTED = st.tuples(*[st.none() | st.sampled_from([kind.reason for kind in KINDS])] * SEGMENTS)
NOVELTY = st.builds(
    Novelty, st.floats(0, 9) | st.just(float("nan")), st.floats(0.1, 9), st.sampled_from(["error", "flag"])
)


def crops(fill: Callable[[], object]) -> Image:
    """21 textured crops, the fifth of them filled otherwise."""
    made = np.random.default_rng(1).integers(60, 160, (SEGMENTS, SEGMENT_PX, SEGMENT_PX)).astype(np.uint8)
    made[4] = fill()
    return made


@given(st.integers(0, 255))
def test_a_crop_of_one_grey_level_has_no_structure(level: int) -> None:
    found = causes(measure_segments(crops(lambda: level), WELDED), LIMITS)
    assert found == tuple(Unseen.NO_STRUCTURE if i == 4 else None for i in range(SEGMENTS))


def dark() -> Image:
    made = np.zeros((SEGMENT_PX, SEGMENT_PX), np.uint8)
    made[32:38] = 200
    return made


def test_each_cause_is_told_with_its_number_and_limit() -> None:
    measured = measure_segments(crops(dark), WELDED)
    assert words(measured, LIMITS) == (
        "segment 5: too dark (91 % of it at grey level 2 or below, limit 50 %)"
    )
    bad = {
        Unseen.NO_STRUCTURE: replace(segment_quality(), contrast=0.01),
        Unseen.TOO_DARK: replace(segment_quality(), mean_dn=3.0),
        Unseen.TOO_BRIGHT: replace(segment_quality(), saturated_fraction=0.9),
        Unseen.BLURRED: replace(segment_quality(), sharpness=0.001),
        Unseen.NO_WELD: replace(segment_quality(), weld=0.0),
        Unseen.COVERED: replace(segment_quality(), visible=0.2),
    }
    assert set(bad) == set(Unseen)
    qualities = [*bad.values(), *[segment_quality()] * (SEGMENTS - len(bad))]
    assert causes(qualities, LIMITS) == (*bad, *[None] * (SEGMENTS - len(bad)))
    line = words(qualities, LIMITS)
    assert line == (
        "segment 1: no structure (contrast 0.010 at grey level 100, limit 0.03); "
        "segment 2: too dark (mean grey level 3.0, limit 15); "
        "segment 3: too bright (90 % of it at grey level 254 or above, limit 50 %); "
        "segment 4: blurred (sharpness 0.001, limit 0.02); "
        "segment 5: no weld between its borders (weld in 0 % of it, limit 25 %); "
        "segment 6: covered (20 % of it visible, limit 40 %)"
    )


def test_segments_of_one_cause_are_told_together_with_the_worst() -> None:
    qualities = [segment_quality()] * SEGMENTS
    qualities[2], qualities[9] = (replace(segment_quality(), mean_dn=dn) for dn in (8.0, 3.0))
    assert words(qualities, LIMITS) == "segments 3, 10: too dark (mean grey level 3.0, limit 15)"


def test_every_value_that_is_not_a_number_fails() -> None:
    for check in CHECKS:
        broken = replace(segment_quality(), **{check.measured: float("nan")})
        assert not check.holds(broken, LIMITS), check.measured


def test_the_values_are_those_of_their_definitions() -> None:
    for crop, quality in zip(crops(dark), measure_segments(crops(dark), WELDED), strict=True):
        rows = np.ascontiguousarray(crop[MIDDLE])
        values, curved = rows.astype(np.float64), cv2.Laplacian(rows, cv2.CV_64F)
        assert quality.mean_dn == pytest.approx(values.mean())
        assert quality.dark_fraction == pytest.approx((values <= 2).mean())
        assert quality.saturated_fraction == pytest.approx((values >= 254).mean())
        assert quality.contrast == pytest.approx(values.std() / values.mean())
        assert quality.sharpness == pytest.approx(np.sqrt((curved**2).mean()) / values.mean())


def test_weld_is_seen_all_round_a_good_part(frames: dict[str, Image], networks: Networks) -> None:
    found = locate(frames[label_with("OK")["frame"]], Expected(), networks.ring, um_per_px=13.0)
    assert found.presence.shape == (SECTORS,)
    assert ((found.presence >= 0) & (found.presence <= 1)).all()
    assert float(np.mean(found.presence >= MIN_PRESENCE)) == found.ring.support == 1.0


def test_the_weld_of_a_segment_is_the_fraction_of_its_sectors_that_show_it() -> None:
    presence = np.ones(SECTORS)
    presence[4:7] = 0.49
    measured = measure_segments(crops(dark), presence, visible=[0.5] * SEGMENTS)
    assert [quality.weld for quality in measured[:3]] == [1.0, 0.25, 1.0]
    assert {quality.visible for quality in measured} == {0.5}


@given(REJECTED, QUALITIES, NOVELTY)
def test_nothing_makes_an_ok_while_a_segment_is_not_seen(
    rejected: tuple[Reason | None, ...], qualities: tuple[object, ...], novelty: Novelty
) -> None:
    unseen = causes(qualities, LIMITS)  # type: ignore[arg-type]
    verdict, reason, detail = decide(rejected, (), qualities, limits=LIMITS, novelty=novelty)  # type: ignore[arg-type]
    within = novelty.value <= novelty.limit
    assert (verdict is Verdict.NOK) == any(rejected), "what is seen to be bad is NOK"
    assert (verdict is Verdict.OK) == (
        not any(rejected) and not any(unseen) and (within or novelty.above == "flag")
    )
    assert (reason is None) == (verdict is Verdict.OK)
    named = {i for i, (cause, bad) in enumerate(zip(unseen, rejected, strict=True), 1) if cause and not bad}
    if named:
        assert detail is not None
        numbers = ", ".join(re.findall(r"segments? ([\d, ]+):", detail)).split(", ")
        assert {int(number) for number in numbers} == named
    made = replace(
        ok_inspection(), verdict=verdict, reason=reason, detail=detail, rejected=rejected, unseen=unseen
    )
    assert made.invalid == tuple(bool(u) and not r for u, r in zip(unseen, rejected, strict=True))
    assert [score is None for score in made.nok_scores] == list(made.invalid)
    result = plc_result(Trigger(1, "S", 0.0, 1), record(made), novel=False, drifting=False, trusted=True)
    assert [bool(result.seg_invalid_mask >> i & 1) for i in range(SEGMENTS)] == list(made.invalid)
    assert [bool(result.seg_nok_mask >> i & 1) for i in range(SEGMENTS)] == list(made.nok)


def test_a_part_without_scores_is_invalid_everywhere() -> None:
    nothing = plc_result(
        Trigger(1, "S", 0.0, 1),
        record(Inspection.error(Reason.NO_WELD_FOUND)),
        novel=False,
        drifting=False,
        trusted=True,
    )
    assert nothing.seg_invalid_mask == (1 << SEGMENTS) - 1


def covered(image: Image, ring: Ring, segment: int, fill: int) -> Image:
    """Return a copy of an image with one segment painted over, a little beyond its ends."""
    rows, columns = np.indices(image.shape)
    dx, dy = columns - ring.center_x_px, rows - ring.center_y_px
    angle = np.degrees(np.arctan2(dy, dx)) % 360
    inside = (angle >= segment * SEGMENT_DEG - 0.4) & (angle <= (segment + 1) * SEGMENT_DEG + 0.4)
    made = image.copy()
    made[inside & (np.abs(np.hypot(dx, dy) - ring.radius_px) <= 70)] = fill
    return made


@pytest.mark.parametrize("segment", [4, 17])
@pytest.mark.parametrize("fill", [0, 1, 12, 60, 128, 200, 254, 255])
def test_a_cover_over_one_segment_of_a_good_part_is_an_error_that_names_it(
    fill: int, segment: int, frames: dict[str, Image], inspector: Inspector
) -> None:
    image = frames[label_with("OK")["frame"]]
    judged = inspector.inspect(covered(image, inspector.locate(image), segment, fill))
    assert (judged.verdict, judged.reason) == (Verdict.ERROR, Reason.SEGMENT_NOT_SEEN)
    assert [i for i, cause in enumerate(judged.unseen) if cause is not None] == [segment]
    assert judged.detail is not None
    assert judged.detail.startswith(f"segment {segment + 1}: ")
    assert judged.nok_scores[segment] is None


def test_a_bad_part_stays_nok_while_another_segment_is_covered(
    frames: dict[str, Image], inspector: Inspector
) -> None:
    image = frames[label_with("hole")["frame"]]
    before = inspector.inspect(image)
    nok = before.nok
    good = next(i for i in range(SEGMENTS) if not (nok[i] or nok[i - 1] or nok[(i + 1) % SEGMENTS]))
    judged = inspector.inspect(covered(image, inspector.locate(image), good, 0))
    assert (judged.verdict, judged.reason) == (Verdict.NOK, Reason.HOLE)
    assert judged.invalid[good]
    assert judged.detail is not None
    assert f"segment {good + 1}: " in judged.detail


@pytest.mark.parametrize("novel", ["error", "flag"])
def test_a_part_unlike_the_training_images_is_not_judged_unless_the_settings_say_so(
    novel: Novel,
    frames: dict[str, Image],
    networks: Networks,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    classifier = networks.classifier
    monkeypatch.setattr(classifier, "card", replace(classifier.card, novelty_limit=0.5))
    inspector = Inspector(
        networks,
        weld=WeldSettings(),
        quality=QualitySettings(),
        model=ModelSettings(novel=novel),
    )
    judged = inspector.inspect(frames[label_with("OK")["frame"]])
    assert inspector.is_novel(judged)
    if novel == "flag":
        assert judged.verdict is Verdict.OK
    else:
        assert (judged.verdict, judged.reason) == (Verdict.ERROR, Reason.UNLIKE_TRAINING)
        assert judged.detail == f"novelty {judged.novelty:.2f}, limit 0.5"
        assert not any(judged.invalid), "its segments were seen and judged"
    bad = inspector.inspect(frames[label_with("hole")["frame"]])
    assert bad.verdict is Verdict.NOK


def _woven(rng: np.random.Generator) -> Image:
    """Return 21 crops (21, 128, 128) uint8 of one texture."""
    grain = rng.normal(0, 1, (SEGMENTS, SEGMENT_PX, SEGMENT_PX)).astype(np.float32)
    smooth = np.stack([cv2.GaussianBlur(crop, (0, 0), 1.5) for crop in grain])
    return np.asarray(np.clip(110 + 60 * smooth, 0, 255), np.uint8)


@pytest.mark.parametrize("angle_deg", [0, 30, 45, 90, 135, 160])
def test_a_smeared_segment_lacks_the_structure_of_one_direction(
    angle_deg: int, rng: np.random.Generator
) -> None:
    made = _woven(rng)
    kernel = np.zeros((41, 41), np.float32)
    kernel[20] = 1
    turn = cv2.getRotationMatrix2D((20, 20), angle_deg, 1.0)
    line = cv2.warpAffine(kernel, turn, (41, 41))
    made[6] = cv2.filter2D(made[6], -1, line / line.sum())
    found = fine_structure(made)
    assert found[6] < LIMITS.min_segment_fine_structure
    assert np.delete(found, 6).min() > 0.8


@given(gain=st.floats(0.4, 1.6))
def test_the_fine_structure_does_not_depend_on_the_light(gain: float) -> None:
    made = _woven(np.random.default_rng(3))
    lit = np.asarray(np.clip(made[4] * gain, 0, 255), np.uint8)
    changed = made.copy()
    changed[4] = lit
    assert fine_structure(changed)[4] == pytest.approx(fine_structure(made)[4], rel=0.12)
