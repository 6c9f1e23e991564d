"""What all sections of station.toml have in common."""

from pydantic import BaseModel, ConfigDict


class Section(BaseModel):
    """Base of all sections: unknown keys are mistakes, values never change."""

    model_config = ConfigDict(extra="forbid", frozen=True)
