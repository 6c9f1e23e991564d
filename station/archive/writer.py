"""Writes records so that none is lost: the verdict can be shown only after files, fsync and index row."""

import hashlib
import sqlite3
import time
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from station.archive.cameras import CameraFeatures
from station.archive.in_progress import InProgress, announce, announced, done
from station.archive.recovery import clear_the_way, move_aside
from station.archive.room import Disk, Room
from station.archive.schema import NAME, SEARCHABLE_SCORE, last_link, link, open_index
from station.domain import Frame, Inspection, Verdict
from station.errors import ImageError, RecordError
from station.files.durable import sync_folder, write_whole
from station.files.image import encode_png
from station.files.lock import hold
from station.files.sqlite import writing
from station.records import Part, Provenance, Record, to_json
from station.settings.model import ArchiveSettings

INCOMING = "incoming.png"
"""File name of the frame of the part in progress."""
TRIAL_S = 1.0
"""Minimum time between two trials to write after a record could not be written."""


@dataclass(frozen=True, slots=True)
class StoredFrame:
    """A frame on disk, under a temporary name until its record is written."""

    sha256: str
    path: Path | None
    """None if the disk is full."""
    camera_sha256: str | None
    """Name of the camera's features; None for a recorded image."""


@dataclass(frozen=True, slots=True)
class Pending:
    """A frame that is written to disk while it is judged."""

    frame: Frame | None
    stored: "Future[StoredFrame] | None"


class Archive:
    """An archive that is open for writing; only one process at a time can have it open."""

    def __init__(self, settings: ArchiveSettings) -> None:
        """Open or create the archive. Raises RecordError if the folder cannot be used."""
        self._folder = settings.folder
        self._stops_when_full = settings.when_full == "stop"
        self._disk = Disk(settings)
        self._cameras = CameraFeatures(settings.folder)
        self._failed_s: float | None = None
        """Time at which a record could not be written; None if the last one was written."""
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            self._lock = hold(self._folder / "engine.lock")
        except BlockingIOError:
            raise RecordError(
                f"{self._folder}: another engine writes its records here; stop it, or set archive.folder"
            ) from None
        except OSError as error:
            raise self._unusable(error) from None
        try:
            for left in sorted(self._folder.glob(f"{INCOMING}*")):
                move_aside(self._folder, left)
            self._index = open_index(self._folder)
            self._following = self._next_id()
            """Number of the next record."""
            found = announced(self._folder)
            self.interrupted = () if found is None else found.unrecorded(self._following)
            """Parts that were being inspected when the engine ended, and have no record."""
            self._chain = last_link(self._index)
            clear_the_way(self._folder, self._following)
        except (OSError, sqlite3.Error, UnicodeError, RecordError) as error:
            if hasattr(self, "_index"):
                self._index.close()
            self._lock.release()
            raise error if isinstance(error, RecordError) else self._unusable(error) from None
        self._encoder = ThreadPoolExecutor(1, "encode")

    def announce(self, part: Part, *, waits: bool = False) -> None:
        """Remember that a part is being inspected: after a sudden end the next start records it as ERROR.

        `waits`: the part comes after the one that is being inspected. May be called from any thread. Raises
        RecordError.
        """
        following = self._following
        before = announced(self._folder) if waits else None
        parts = () if before is None else before.unrecorded(following)
        try:
            announce(self._folder, InProgress((*parts, part), following))
        except OSError as error:
            raise RecordError(f"{self._folder}: the part in progress cannot be noted: {error}") from None

    def _next_id(self) -> int:
        row = self._index.execute("SELECT seq FROM sqlite_sequence WHERE name = 'records'").fetchone()
        return 1 + (row[0] if row else 0)

    def _unusable(self, error: Exception) -> RecordError:
        return RecordError(
            f"{self._folder}: records cannot be written ({error}); set archive.folder to a writable folder"
        )

    def close(self) -> None:
        """Finish writing and close the archive."""
        self._encoder.shutdown(wait=True)
        self._index.close()
        self._lock.release()

    def room(self) -> Room:
        """Return the level of free space on the disk."""
        return self._disk.room()

    def has_room(self) -> bool:
        """Return whether parts can be accepted: records can be written, and the disk is not full."""
        return self._writes() and (self.room() > Room.FULL or not self._stops_when_full)

    def _writes(self) -> bool:
        """Return whether records can be written; after a failed record, try once a second."""
        if self._failed_s is None:
            return True
        if time.monotonic() - self._failed_s < TRIAL_S:
            return False
        try:
            write_whole(self._folder / "trial", b"", durable=True)
            (self._folder / "trial").unlink()
            with writing(self._index, self._folder / NAME):
                pass
        except (OSError, sqlite3.Error):
            self._failed_s = time.monotonic()
            return False
        self._failed_s = None
        return True

    def begin(self, frame: Frame | None) -> Pending:
        """Start to write a frame while it is being judged; without `commit`, the next frame overwrites it."""
        return Pending(frame, None if frame is None else self._encoder.submit(self._store, frame))

    def _store(self, frame: Frame) -> StoredFrame:
        png = encode_png(frame.image)
        sha256 = hashlib.sha256(png).hexdigest()
        camera_sha256 = self._cameras.keep(frame.features) if frame.features else None
        if self.room() is Room.FULL:
            return StoredFrame(sha256, None, camera_sha256)
        path = self._folder / INCOMING
        write_whole(path, png, durable=True)
        return StoredFrame(sha256, path, camera_sha256)

    def commit(
        self, pending: Pending, inspection: Inspection, part: Part, provenance: Provenance, *, now: datetime
    ) -> Record:
        """Write the record durably and return it. Raises RecordError; then the index has no entry of it."""
        try:
            return self._commit(pending, inspection, part, provenance, now=now)
        except (OSError, sqlite3.Error, ImageError, ValueError) as error:
            self._failed_s = time.monotonic()
            raise RecordError(f"{self._folder}: the record could not be written: {error}") from None

    def mark_shown(self, inspection_id: int, shown: bool) -> None:
        """Note in the index whether the verdict was shown to the PLC. Raises RecordError."""
        try:
            with writing(self._index, self._folder / NAME):
                self._index.execute(
                    "UPDATE records SET shown_to_plc = ? WHERE inspection_id = ?", (shown, inspection_id)
                )
        except sqlite3.Error as error:
            raise RecordError(
                f"{self._folder}: record {inspection_id} could not be marked: {error}"
            ) from None

    def _commit(
        self, pending: Pending, inspection: Inspection, part: Part, provenance: Provenance, *, now: datetime
    ) -> Record:
        inspection_id = self._next_id()
        day = self._folder / f"{now:%Y-%m-%d}"
        if not day.exists():
            day.mkdir()
            sync_folder(self._folder)
        for suffix in ("png", "json"):  # left over from a part whose record failed
            if (left := day / f"{inspection_id:08d}.{suffix}").exists():
                move_aside(self._folder, left)
        frame_file = sha256 = camera_sha256 = None
        state = "none" if pending.frame is None else "kept"
        if pending.stored is not None:
            stored = pending.stored.result()
            sha256, camera_sha256 = stored.sha256, stored.camera_sha256
            if stored.path is not None and (self.room() > Room.THIN or inspection.verdict is not Verdict.OK):
                frame_file = f"{day.name}/{inspection_id:08d}.png"
                stored.path.replace(self._folder / frame_file)
            else:
                state = "thinned"
        record = Record(
            inspection_id=inspection_id,
            serial=part.serial,
            trigger_id=part.trigger_id,
            grabbed_at=now if pending.frame is None else pending.frame.grabbed_at,
            source="" if pending.frame is None else pending.frame.source,
            origin=part.origin,
            frame_file=frame_file,
            frame_sha256=sha256,
            inspection=inspection,
            provenance=provenance,
            purpose=part.purpose,
            camera_sha256=camera_sha256,
            chain_before=self._chain,
        )
        text = to_json(record)
        record_file = f"{day.name}/{inspection_id:08d}.json"
        write_whole(self._folder / record_file, text, durable=True)
        sync_folder(day)
        self._list(record, record_file, hashlib.sha256(text).hexdigest(), state)
        with suppress(OSError):  # the numbers say which parts have their records
            done(self._folder, self._following)
        return record

    def _list(self, record: Record, record_file: str, sha256: str, frame_state: str) -> None:
        inspection = record.inspection
        chain = link(self._chain, sha256)
        found = [
            (record.inspection_id, number, score)
            for number, score in enumerate(inspection.nok_scores, start=1)
            if score is not None and score >= SEARCHABLE_SCORE
        ]
        values = {
            "inspection_id": record.inspection_id,
            "serial": record.serial,
            "trigger_id": record.trigger_id,
            "grabbed_at": record.grabbed_at.isoformat(),
            "origin": record.origin,
            "verdict": inspection.verdict,
            "reason": inspection.reason,
            "worst_score": inspection.worst,
            "frame_file": record.frame_file,
            "record_file": record_file,
            "record_sha256": sha256,
            "purpose": record.purpose,
            "recipe": record.provenance.recipe,
            "chain": chain,
            "frame_state": frame_state,
        }
        with writing(self._index, self._folder / NAME):
            marks = ", ".join(f":{name}" for name in values)
            self._index.execute(f"INSERT INTO records ({', '.join(values)}) VALUES ({marks})", values)
            self._index.executemany("INSERT INTO segments VALUES (?, ?, ?)", found)
        self._chain, self._following = chain, record.inspection_id + 1
