"""Rules that apply to every section of station.toml."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field


def _text_only(value: Any) -> Any:
    """Return the value unless it is a number, which an address would take for one of its forms."""
    if isinstance(value, (bool, int, float, bytes)):
        raise ValueError("should be a text")
    return value


FROM_TEXT = Field(strict=False)
"""Metadata of a type that is written as a text, such as an address."""
TEXT_ONLY = BeforeValidator(_text_only)
"""Metadata of a value that must be written as a text."""
FilePath = Annotated[Path, TEXT_ONLY, FROM_TEXT]
"""Path of a file or folder, written as a text."""


class Section(BaseModel):
    """Base class of all sections: unknown keys are refused, values are immutable.

    Types are strict: true does not count as 1 nor "0.6" as 0.6, and numbers are finite.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)
