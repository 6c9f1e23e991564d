"""Rules that apply to every section of station.toml."""

from pydantic import BaseModel, ConfigDict


class Section(BaseModel):
    """Base class of all sections: unknown keys are refused, values are immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True)
