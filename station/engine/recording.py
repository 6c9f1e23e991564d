"""Writes records for the cycle: a part whose record cannot be written becomes ERROR, nothing is raised."""

import logging
from datetime import UTC, datetime

from station.archive.writer import Archive, Pending
from station.defects import Reason
from station.domain import Inspection
from station.errors import RecordError
from station.records import Part, Provenance, Record

log = logging.getLogger("weldgate.recorder")

INTERRUPTED = "the engine ended while the part was inspected"
"""Detail in the record of such a part."""


def write_record(
    archive: Archive,
    pending: Pending,
    inspection: Inspection,
    part: Part,
    *,
    provenance: Provenance,
) -> Record:
    """Return the durable record, or an unrecorded one with verdict ERROR if it could not be written."""
    try:
        return archive.commit(pending, inspection, part, provenance, now=datetime.now(UTC))
    except RecordError as error:
        log.error("%s", error)
    except Exception:  # the PLC needs an answer, and without a record it must not be a verdict
        log.exception("the record could not be written")
    failed = Inspection.error(Reason.RECORD_FAILED, inspection.ring, inspection.quality, inspection.timing)
    return unrecorded(failed, part, provenance)


def unrecorded(failed: Inspection, part: Part, provenance: Provenance) -> Record:
    """Return a record that exists in memory only and has the number 0."""
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
    """Note in the index whether the PLC could read the verdict."""
    try:
        archive.mark_shown(record.inspection_id, shown)
    except RecordError as error:
        log.error("%s", error)


def note_in_progress(archive: Archive, part: Part, *, waits: bool = False) -> None:
    """Note on disk that a part is being inspected, or `waits` for the one that is."""
    try:
        archive.announce(part, waits=waits)
    except RecordError as error:
        log.error("%s", error)


def record_interrupted(archive: Archive, provenance: Provenance) -> list[Record]:
    """Return the records, ERROR, of the parts during which the engine ended."""
    records = []
    for part in archive.interrupted:
        inspection = Inspection.error(Reason.INTERNAL, detail=INTERRUPTED)
        record = write_record(archive, archive.begin(None), inspection, part, provenance=provenance)
        log.error("part %d, %s: %s", record.inspection_id, part.serial, INTERRUPTED)
        records.append(record)
    archive.interrupted = ()
    return records
