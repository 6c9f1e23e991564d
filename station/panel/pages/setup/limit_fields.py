"""The limits that can be changed in the window, by the keys of the settings; pure."""

from station.classify.onnx import Classifier
from station.classify.thresholds import Limit, Thresholds, in_use
from station.defects import KINDS
from station.panel.pages.setup.what_if_state import Values
from station.settings.model import QualitySettings, Settings

THRESHOLD, MIN_MM = "limits.{}.threshold", "limits.{}.min_mm"
"""Keys of the limits of a kind of defect, with a place for its name."""
FIELDS: dict[str, tuple[str, float, float]] = {
    **{THRESHOLD.format(kind.name): ("model", 0.01, 0.99) for kind in KINDS},
    **{MIN_MM.format(kind.name): ("model", 0.0, 5.0) for kind in KINDS},
    "min_mean_dn": ("quality", 0.0, 255.0),
    "max_dark_share": ("quality", 0.0, 1.0),
    "max_saturated_share": ("quality", 0.0, 1.0),
    "min_sharpness": ("quality", 0.0, 10.0),
}
"""Section of the settings, minimum and maximum of each key."""


def limits_in_use(settings: Settings) -> dict[str, float]:
    """Return the limits in use for the kinds of defect that the model knows, by key.

    They come from the settings, or from the model where the settings have none.
    Raises ModelError, SettingsError.
    """
    model = settings.model
    used = in_use(Classifier(model.path, 1).card.thresholds, model.limits, model.segment_thresholds).kinds
    values = {THRESHOLD.format(limit.kind.name): limit.threshold for limit in used}
    values |= {MIN_MM.format(limit.kind.name): limit.min_mm for limit in used}
    return values | {
        key: float(getattr(settings.quality, key))
        for key, (section, _, _) in FIELDS.items()
        if section == "quality"
    }


def thresholds_of(values: Values) -> Thresholds:
    """Return the limits of the fields that decide on rejects."""
    limits = tuple(
        Limit(kind, values.limits[THRESHOLD.format(kind.name)], values.limits[MIN_MM.format(kind.name)])
        for kind in KINDS
        if THRESHOLD.format(kind.name) in values.limits
    )
    return Thresholds(limits, tuple(sorted(values.segments.items())))


def quality_of(values: Values, settings: Settings) -> QualitySettings:
    """Return the settings of the image quality check with the limits of the fields."""
    changed = {key: value for key, value in values.limits.items() if FIELDS[key][0] == "quality"}
    return settings.quality.model_copy(update=changed)


def place_of(key: str, recipe: int) -> tuple[str, ...]:
    """Return the place of a key in the settings, names from the top."""
    return "recipes", str(recipe), FIELDS[key][0], *key.split(".")
