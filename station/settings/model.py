"""The sections and values of station.toml, with their defaults and allowed ranges."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, ValidationError, model_validator

from station.defects import kind_named
from station.domain import NETWORK_UM_PER_PX, TRAINED_UM_PER_PX
from station.errors import SettingsError
from station.numbers import number_key
from station.settings.camera import AnyCamera, ReplaySettings
from station.settings.plc import PlcSettings as PlcSettings
from station.settings.plc import TlsSettings as TlsSettings
from station.settings.quality import Fraction
from station.settings.quality import QualitySettings as QualitySettings
from station.settings.section import FilePath, Section

FORMER_CHANNEL = ("host", "events_port", "preview_port", "requests_port")
"""Keys of [channel] when it was reached over TCP."""
KindName = Annotated[str, AfterValidator(lambda name: kind_named(name).name)]
"""Name of a known kind of defect."""


def _trained(um_per_px: float) -> float:
    low, high = TRAINED_UM_PER_PX
    if not low <= um_per_px <= high:
        raise ValueError(
            f"the networks are trained for {low:g} to {high:g} µm/px, not for {um_per_px:g}; "
            "use another lens, or train networks for it"
        )
    return um_per_px


class WeldSettings(Section):
    """Size of the weld in mm, and scale of the images."""

    radius_mm: float = Field(default=5.564, gt=0)
    radius_tolerance_mm: float = Field(default=0.156, gt=0)
    um_per_px: Annotated[float, AfterValidator(_trained)] = NETWORK_UM_PER_PX


class LimitSettings(Section):
    """Limits of one kind of defect."""

    threshold: Fraction | None = None
    """Score from which a segment is rejected; None: the threshold in the classifier file."""
    min_mm: float = Field(default=0.0, ge=0, le=5)
    """Minimum length: shorter findings are reported but tolerated, if they could be measured."""


class ModelSettings(Section):
    """Network files, self-test, and limits of the decision."""

    path: FilePath = Path("weldgate.onnx")
    ring_path: FilePath = Path("ring.onnx")
    seen_path: FilePath = Path("seen.onnx")
    """Network that says how much of the weld is hidden in a crop."""
    reference_path: FilePath | None = None
    """File with the appearance of the line's own good parts; None: drift is not monitored."""
    threads: int = Field(default=2, ge=1, le=64)
    self_test_path: FilePath | None = None
    """Frame of the self-test, judged at the start and between parts; its scores must never change.

    None: a shipped frame, if it fits the weld.
    """
    self_test_verdict: Literal["OK", "NOK"] | None = None
    """Verdict that the self-test must give at the start."""
    self_test_s: float = Field(default=10.0, ge=0.5, le=3600)
    """Time between two self-tests while no part comes, in seconds."""
    self_test_age_s: float = Field(default=300.0, ge=0.5, le=86_400)
    """Age of the last self-test at which it is run between two parts, however busy the line is."""
    novel: Literal["error", "flag"] = "error"
    """A part that would be OK but is unlike all training images: not judged (error), or OK with the flag
    NOVEL (flag)."""
    limits: dict[KindName, LimitSettings] = Field(default_factory=dict)
    """Limits by name of the kind of defect."""
    segment_thresholds: dict[
        Annotated[int, BeforeValidator(number_key), Field(ge=1, le=21)],
        Annotated[float, Field(ge=0.01, le=0.99)],
    ] = Field(default_factory=dict)
    """Thresholds of single segments, which apply to all kinds of defect."""

    @model_validator(mode="after")
    def _self_test_is_whole(self) -> "ModelSettings":
        if (self.self_test_path is None) != (self.self_test_verdict is None):
            raise ValueError("self_test_path and self_test_verdict belong together")
        return self


class GoldenSettings(Section):
    """Masters: parts of known verdict for the master check."""

    masters: dict[str, Literal["OK", "NOK"]] = Field(default_factory=dict)
    """Serial of each master and the verdict that the station must give."""
    due_h: float | None = Field(default=None, gt=0, le=8760)
    """Hours after which a master must be judged again; a master that is due sets FUNCTION_CHECK, with which
    the PLC block releases no part. None: never."""


class RecipeSettings(Section):
    """Values of one type of part that differ from the sections of the same name."""

    weld: dict[str, Any] = Field(default_factory=dict)
    quality: dict[str, Any] = Field(default_factory=dict)
    model: dict[str, Any] = Field(default_factory=dict)


Days = Annotated[int, Field(ge=1, le=36500)]
"""Retention in days."""


class KeepSettings(Section):
    """Retention of frames and records."""

    ok_all_days: Days = 7
    """Retention of the frames of all OK parts."""
    ok_share: Fraction = 0.1
    """Fraction of the OK parts whose frames are kept after that; the part's number decides."""
    ok_days: Days = 90
    """Retention of the frames of this fraction of the OK parts."""
    nok_days: Days = 730
    error_days: Days = 365
    record_days: Days = 3650
    """Retention of the records themselves."""
    quota_gib: float = Field(default=500.0, gt=0)
    """Maximum size of all frames; above it the oldest OK frames are deleted first, then ERROR, then NOK."""


class ArchiveSettings(Section):
    """Folder of the records, and what happens when the disk fills up."""

    folder: FilePath = Path("records")
    warn_free_mb: int = Field(default=10_000, ge=1)
    """Free space below which the station warns."""
    thin_free_mb: int = Field(default=2_000, ge=1)
    """Free space below which frames of OK parts are not stored."""
    min_free_mb: int = Field(default=500, ge=1)
    """Free space below which the disk counts as full."""
    when_full: Literal["stop", "no_pictures"] = "stop"
    """On a full disk, accept no parts (stop), or continue with records but no frames (no_pictures)."""
    keep: KeepSettings = KeepSettings()
    bus_days: Days = 30
    """Retention of the log of the PLC bus."""

    @model_validator(mode="after")
    def _levels_in_order(self) -> "ArchiveSettings":
        if not self.min_free_mb <= self.thin_free_mb <= self.warn_free_mb:
            raise ValueError("min_free_mb <= thin_free_mb <= warn_free_mb is needed")
        return self


class ChannelSettings(Section):
    """Local channel between engine and window (ZeroMQ over Unix sockets)."""

    folder: FilePath = Path("channel")
    """Folder of the sockets. The engine makes it for its own account; a group may be admitted by its mode."""

    @model_validator(mode="before")
    @classmethod
    def _has_no_ports(cls, raw: Any) -> Any:
        ports = [key for key in raw if key in FORMER_CHANNEL] if isinstance(raw, Mapping) else []
        if ports:
            raise ValueError(
                f"{', '.join(ports)}: no longer used, because every account of the machine can reach a port; "
                "engine and window meet in channel.folder. Delete the line"
            )
        return raw


class PanelSettings(Section):
    """State of the operator's window when it opens."""

    language: Literal["en", "de"] = "en"
    theme: Literal["dark", "light"] = "dark"
    logout_min: float = Field(default=10.0, ge=0.1, le=480)
    """Minutes without input after which a user is logged out."""


class Settings(Section):
    """Complete settings of a station: the sections of station.toml."""

    camera: Annotated[AnyCamera, Field(discriminator="kind")]
    weld: WeldSettings = WeldSettings()
    quality: QualitySettings = QualitySettings()
    model: ModelSettings = ModelSettings()
    plc: PlcSettings = PlcSettings()
    archive: ArchiveSettings = ArchiveSettings()
    channel: ChannelSettings = ChannelSettings()
    golden: GoldenSettings = GoldenSettings()
    panel: PanelSettings = PanelSettings()
    recipes: dict[Annotated[int, BeforeValidator(number_key), Field(ge=1, le=65535)], RecipeSettings] = Field(
        default_factory=dict
    )
    """Recipes by number; recipe 1 uses the sections unchanged unless it is listed here."""


def for_images(networks: Path) -> Settings:
    """Return settings for recorded images without a settings file: default limits, networks in a folder."""
    camera = ReplaySettings(kind="replay", folder=Path())
    return Settings(
        camera=camera,
        model=ModelSettings(
            path=networks / "weldgate.onnx",
            ring_path=networks / "ring.onnx",
            seen_path=networks / "seen.onnx",
        ),
    )


def for_recipe(settings: Settings, number: int) -> Settings:
    """Return the settings of one recipe.

    Raises SettingsError if no recipe has this number, pydantic.ValidationError if its values are not allowed.
    """
    changes = settings.recipes.get(number)
    if changes is None:
        if number == 1:
            return settings
        raise SettingsError(
            f"recipe {number} does not exist; recipes: {', '.join(map(str, sorted({1, *settings.recipes})))}"
        )
    sections: dict[str, Section] = {}
    for name, section in (("weld", settings.weld), ("quality", settings.quality), ("model", settings.model)):
        sections[name] = type(section).model_validate(merged(section.model_dump(), getattr(changes, name)))
    return settings.model_copy(update=sections)


def for_scale(settings: Settings, um_per_px: float) -> Settings:
    """Return the settings for images of this scale. Raises SettingsError if no network is trained for it."""
    try:
        weld = WeldSettings.model_validate({**settings.weld.model_dump(), "um_per_px": um_per_px})
    except ValidationError as error:
        text = error.errors()[0]["msg"].removeprefix("Value error, ")
        raise SettingsError(f"scale of the images: {text}") from None
    return settings.model_copy(update={"weld": weld})


def merged(values: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a section overridden by changes; limits are merged per defect kind and key."""
    result = {**values, **changes}
    before, after = values.get("limits"), changes.get("limits")
    if isinstance(before, Mapping) and isinstance(after, Mapping):
        kinds = {name: _over(before.get(name), own) for name, own in after.items()}
        result["limits"] = {**before, **kinds}
    return result


def _over(before: object, after: object) -> object:
    return {**before, **after} if isinstance(before, Mapping) and isinstance(after, Mapping) else after
