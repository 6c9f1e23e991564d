"""The archive as the gate needs it: a record that cannot be kept is one that says ERROR, and nothing is raised."""

import logging
from datetime import UTC, datetime

from station.archive.writer import Archive, Pending
from station.defects import Reason
from station.domain import Inspection
from station.errors import RecordError
from station.records import Part, Provenance, Record

log = logging.getLogger("weldgate.recorder")


def keep(
    archive: Archive,
    pending: Pending,
    inspection: Inspection,
    part: Part,
    *,
    provenance: Provenance,
) -> Record:
    """The durable record, or, if it cannot be made durable, one in memory that says ERROR."""
    try:
        return archive.commit(pending, inspection, part, provenance, now=datetime.now(UTC))
    except RecordError as error:
        log.error("%s", error)
    except Exception:  # the gate must answer, and without a record never with a verdict
        log.exception("the record could not be written")
    failed = Inspection.error(Reason.RECORD_FAILED, inspection.ring, inspection.quality, inspection.timing)
    return unkept(failed, part, provenance)


def unkept(failed: Inspection, part: Part, provenance: Provenance) -> Record:
    """In memory alone, with the number 0."""
    return Record(
        inspection_id=0,
        serial=part.serial,
        trigger_id=part.trigger_id,
        grabbed_at=datetime.now(UTC),
        source="",
        origin=part.origin,
        frame_file=None,
        frame_sha256=None,
        inspection=failed,
        provenance=provenance,
        purpose=part.purpose,
    )


def mark_shown(archive: Archive, record: Record, shown: bool) -> None:
    """Whether the PLC was shown the verdict."""
    try:
        archive.mark_shown(record.inspection_id, shown)
    except RecordError as error:
        log.error("%s", error)
