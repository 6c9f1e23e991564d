"""station.toml as checked values."""

from collections.abc import Mapping
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, model_validator

from station.defects import kind_named
from station.errors import SettingsError
from station.register_windows import COMMAND_START, COMMAND_WORDS, STATUS_START, STATUS_WORDS
from station.settings.camera import AnyCamera, ReplaySettings
from station.settings.section import Section

Port = Annotated[int, Field(ge=1, le=65535)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
KindName = Annotated[str, AfterValidator(lambda name: kind_named(name).name)]


class WeldSettings(Section):
    """What is known of the weld."""

    radius_mm: float = Field(default=5.564, gt=0)
    radius_tolerance_mm: float = Field(default=0.156, gt=0)
    um_per_px: float = Field(default=13.0, gt=0)


class QualitySettings(Section):
    """Limits of the image quality gate, on the strip."""

    min_mean_dn: float = Field(default=12.0, ge=0, le=255)
    max_dark_share: Share = 0.6
    max_saturated_share: Share = 0.35
    min_sharpness: float = Field(default=0.01, ge=0)


class LimitSettings(Section):
    """Limits of one kind of defect."""

    threshold: Share | None = None
    """Score from which a segment is rejected; None: as the classifier file says."""
    min_mm: float = Field(default=0.0, ge=0, le=5)
    """Shorter findings are reported but tolerated, if they could be measured."""


class ModelSettings(Section):
    """The networks, and the limits of the decision."""

    path: Path = Path("weldgate.onnx")
    ring_path: Path = Path("ring.onnx")
    reference_path: Path | None = None
    """Look of the line's own good parts; without it drifting pictures are not watched for."""
    threads: int = Field(default=2, ge=1, le=64)
    self_test_path: Path | None = None
    """Frame that is judged at the start and again while idle: its scores must never change."""
    self_test_verdict: Literal["OK", "NOK"] | None = None
    """What must be found in it at the start."""
    self_test_s: float = Field(default=10.0, ge=0.5, le=3600)
    """Idle time between two self-tests."""
    limits: dict[KindName, LimitSettings] = Field(default_factory=dict)
    """By the name of the kind of defect."""
    segment_thresholds: dict[
        Annotated[int, Field(ge=1, le=21)], Annotated[float, Field(ge=0.01, le=0.99)]
    ] = Field(default_factory=dict)
    """Thresholds of single segments, for any kind of defect."""

    @model_validator(mode="after")
    def _self_test_is_whole(self) -> "ModelSettings":
        if (self.self_test_path is None) != (self.self_test_verdict is None):
            raise ValueError("self_test_path and self_test_verdict belong together")
        return self


class TlsSettings(Section):
    """Modbus/TCP Security: both sides show a certificate (`weldgate certificates` makes some for trials)."""

    certificate_path: Path
    key_path: Path
    ca_path: Path
    """Whose certificates are trusted."""


class GoldenSettings(Section):
    """Parts known to be good or bad, to be judged when the PLC asks for it."""

    masters: dict[str, Literal["OK", "NOK"]] = Field(default_factory=dict)
    """Serial of each master and what the station must find."""
    due_h: float | None = Field(default=None, gt=0, le=8760)
    """A master not judged for so long is due: FUNCTION_CHECK, which the PLC's block takes for no release; None: never."""


class RecipeSettings(Section):
    """What differs from the sections of the same name for one kind of part."""

    weld: dict[str, Any] = Field(default_factory=dict)
    quality: dict[str, Any] = Field(default_factory=dict)
    model: dict[str, Any] = Field(default_factory=dict)


class PlcSettings(Section):
    """The PLC: where, who may write, and the times of the handshake."""

    mode: Literal["server", "client"] = "server"
    """server: the PLC reaches into our registers; client: we reach into the PLC's."""
    host: str = "127.0.0.1"
    """server: our address; client: the PLC's."""
    port: Port = 1502
    unit: int = Field(default=1, ge=0, le=255)
    command_base: int = Field(default=COMMAND_START, ge=0, le=65536 - COMMAND_WORDS)
    status_base: int = Field(default=STATUS_START, ge=0, le=65536 - STATUS_WORDS)
    """Addresses of the windows in the PLC (client)."""
    poll_ms: int = Field(default=20, ge=5, le=1000)
    timeout_ms: int = Field(default=400, ge=50, le=5000)
    """Answer to one request (client)."""
    low_word_first: bool = False
    """Word order of 32-bit values; the test pattern shows which one is right."""
    allow: tuple[IPv4Network | IPv6Network, ...] = ()
    """Peers that may connect (server); empty: all."""
    writer_idle_ms: int = Field(default=2_000, ge=100, le=600_000)
    """A peer that has not written for so long loses the right to write to the next (server)."""
    tls: TlsSettings | None = None
    deadline_ms: int = Field(default=2000, ge=100, le=60_000)
    result_ttl_ms: int = Field(default=10_000, ge=100, le=600_000)
    stuck_ms: int = Field(default=5_000, ge=100, le=600_000)
    plc_heartbeat_ms: int = Field(default=2_000, ge=0, le=60_000)
    """PLC_HEARTBEAT must change within this time; 0: not watched."""

    @model_validator(mode="after")
    def _windows_apart(self) -> "PlcSettings":
        command = range(self.command_base, self.command_base + COMMAND_WORDS)
        status = range(self.status_base, self.status_base + STATUS_WORDS)
        if command.start < status.stop and status.start < command.stop:
            sizes = f"windows of {COMMAND_WORDS} and {STATUS_WORDS} registers overlap"
            raise ValueError(f"command_base {command.start} and status_base {status.start}: {sizes}")
        return self


Days = Annotated[int, Field(ge=1, le=36500)]


class KeepSettings(Section):
    """How long pictures and records are kept."""

    ok_all_days: Days = 7
    """Pictures of all OK parts."""
    ok_share: Share = 0.1
    """Of the OK parts after that, chosen by their number."""
    ok_days: Days = 90
    nok_days: Days = 730
    error_days: Days = 365
    record_days: Days = 3650
    """Records themselves."""
    quota_gib: float = Field(default=500.0, gt=0, allow_inf_nan=False)
    """Of pictures; the oldest OK go first, then those not judged, then NOK."""


class ArchiveSettings(Section):
    """Where records go, and what happens when the disk fills."""

    folder: Path = Path("records")
    warn_free_mb: int = Field(default=10_000, ge=1)
    """Below this the station warns."""
    thin_free_mb: int = Field(default=2_000, ge=1)
    """Below this pictures of OK parts are left out."""
    min_free_mb: int = Field(default=500, ge=1)
    when_full: Literal["stop", "no_pictures"] = "stop"
    """Below min_free_mb: take no parts, or go on with records alone."""
    keep: KeepSettings = KeepSettings()
    bus_days: Days = 30
    """How long the edges of the PLC bus are kept."""

    @model_validator(mode="after")
    def _levels_in_order(self) -> "ArchiveSettings":
        if not self.min_free_mb <= self.thin_free_mb <= self.warn_free_mb:
            raise ValueError("min_free_mb <= thin_free_mb <= warn_free_mb is needed")
        return self


def _loopback(address: IPv4Address | IPv6Address) -> IPv4Address | IPv6Address:
    if not address.is_loopback:
        raise ValueError("must be an address of this machine alone, as 127.0.0.1")
    return address


class ChannelSettings(Section):
    """Local channel between engine and panel (ZeroMQ). It knows neither login nor encryption and carries times of this machine's clock:
    loopback only."""

    host: Annotated[IPv4Address | IPv6Address, AfterValidator(_loopback)] = IPv4Address("127.0.0.1")
    events_port: Port = 15551
    preview_port: Port = 15552
    requests_port: Port = 15553


class PanelSettings(Section):
    """The operator's window, as it opens."""

    language: Literal["en", "de"] = "en"
    theme: Literal["dark", "light"] = "dark"
    logout_min: float = Field(default=10.0, ge=0.1, le=480)


class Settings(Section):
    """The whole of station.toml."""

    camera: Annotated[AnyCamera, Field(discriminator="kind")]
    weld: WeldSettings = WeldSettings()
    quality: QualitySettings = QualitySettings()
    model: ModelSettings = ModelSettings()
    plc: PlcSettings = PlcSettings()
    archive: ArchiveSettings = ArchiveSettings()
    channel: ChannelSettings = ChannelSettings()
    golden: GoldenSettings = GoldenSettings()
    panel: PanelSettings = PanelSettings()
    recipes: dict[Annotated[int, Field(ge=1, le=65535)], RecipeSettings] = Field(default_factory=dict)
    """By number; recipe 1 is the sections as they are, unless it is named here."""


def for_images(networks: Path) -> Settings:
    """Settings to judge recorded images by, without a file: the default limits, and the networks in a folder."""
    camera = ReplaySettings(kind="replay", folder=Path())
    return Settings(
        camera=camera, model=ModelSettings(path=networks / "weldgate.onnx", ring_path=networks / "ring.onnx")
    )


def for_recipe(settings: Settings, number: int) -> Settings:
    """The settings of one recipe. Raises SettingsError if there is none of that number, pydantic.ValidationError."""
    changes = settings.recipes.get(number)
    if changes is None:
        if number == 1:
            return settings
        raise SettingsError(
            f"there is no recipe {number}; recipes: {', '.join(map(str, sorted({1, *settings.recipes})))}"
        )
    sections: dict[str, Section] = {}
    for name, section in (("weld", settings.weld), ("quality", settings.quality), ("model", settings.model)):
        sections[name] = type(section).model_validate(merged(section.model_dump(), getattr(changes, name)))
    return settings.model_copy(update=sections)


def merged(values: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return a section's values with changes laid over them; the limits of each kind of defect key by key."""
    answer = {**values, **changes}
    before, after = values.get("limits"), changes.get("limits")
    if isinstance(before, Mapping) and isinstance(after, Mapping):
        kinds = {name: _over(before.get(name), own) for name, own in after.items()}
        answer["limits"] = {**before, **kinds}
    return answer


def _over(before: object, after: object) -> object:
    return {**before, **after} if isinstance(before, Mapping) and isinstance(after, Mapping) else after
