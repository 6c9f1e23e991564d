"""One row of the index, checked when it is read: an index can be damaged, or made by somebody else."""

import re
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Any

from pydantic import AfterValidator, Field, TypeAdapter, ValidationError

from station.errors import RecordError

RECORD_FILE = re.compile(r"\d{4}-\d\d-\d\d/\d{8,18}\.json", re.ASCII)
"""Names of records; another name could lead out of the archive."""
FRAME_FILE = re.compile(r"\d{4}-\d\d-\d\d/\d{8,18}\.png", re.ASCII)
"""Names of frames."""


def _time(text: str) -> str:
    if datetime.fromisoformat(text).utcoffset() is None:
        raise ValueError("has no offset from UTC")
    return text


def _named(pattern: re.Pattern[str]) -> AfterValidator:
    def check(name: str) -> str:
        if not pattern.fullmatch(name):
            raise ValueError("is not the name of a file of the archive")
        return name

    return AfterValidator(check)


Number = Annotated[int, Field(strict=True, ge=0, lt=1 << 62)]
Whole = Annotated[int, Field(strict=True)]
Text = Annotated[str, Field(strict=True)]
Truth = Annotated[bool, Field(strict=True)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One row of the index."""

    inspection_id: Number
    serial: Text
    trigger_id: Whole
    grabbed_at: Annotated[Text, AfterValidator(_time)]
    verdict: Annotated[Text, Field(pattern="^(OK|NOK|ERROR)$")]
    reason: Text | None
    worst_score: Annotated[float, Field(strict=True, ge=0, le=1)] | None
    frame_file: Annotated[Text, _named(FRAME_FILE)] | None
    frame_state: Annotated[Text, Field(pattern="^(kept|thinned|pruned|none)$")]
    """kept, thinned (not stored for lack of space), pruned (deleted) or none (there was no frame)."""
    record_file: Annotated[Text, _named(RECORD_FILE)]
    record_sha256: Text
    shown_to_plc: Truth | None
    """True if the PLC could read the verdict; None if the station stopped before it could note this."""
    purpose: Annotated[Text, Field(pattern="^(part|golden|test)$")]
    recipe: Whole
    chain: Text | None


_ADAPTER = TypeAdapter(Row)


def as_row(values: dict[str, Any]) -> Row:
    """Return a row of the index with these values. Raises RecordError if it is damaged."""
    shown = {0: False, 1: True}.get(values["shown_to_plc"], values["shown_to_plc"])
    try:
        return _ADAPTER.validate_python({**values, "shown_to_plc": shown})
    except ValidationError as error:
        first = error.errors()[0]
        name, number = first["loc"][0], values["inspection_id"]
        raise RecordError(f"the index is damaged: record {number!r}: {name}: {first['msg']}") from None
