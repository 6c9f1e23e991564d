"""Compares the results of a replay with the records of the line."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from station.archive.reader import read_record
from station.domain import Verdict
from station.records import Provenance
from station.replay.files import Source
from station.replay.replayed import Replayed


@dataclass(frozen=True, slots=True, kw_only=True)
class Flip:
    """A part whose verdict differs from that of the line."""

    name: str
    before: Verdict
    now: Verdict
    worst_before: float | None
    """Highest score of NOK on the line."""
    worst_now: float | None
    """Highest score of NOK in the replay."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Comparison of the verdicts of the line with those of the replay."""

    compared: int
    """Number of records that were compared."""
    same_judge: int
    """Number of records made with the same networks, limits and settings; these must agree bit for bit."""
    not_alike: tuple[str, ...]
    """Names of the records among these that do not agree."""
    flips: tuple[Flip, ...]
    problems: tuple[str, ...]
    """One line for each record that was not compared, because it cannot be read, its frame was modified, or
    it was judged at another scale."""

    def lines(self) -> list[str]:
        """Return the comparison as lines for the terminal."""
        lines = [f"compared with the line: {self.compared} parts, {len(self.flips)} verdicts flip"]
        for before, now in (("NOK", "OK"), ("OK", "NOK")):
            flipped = [flip for flip in self.flips if (flip.before, flip.now) == (before, now)]
            lines.append(
                f"  {before} to {now}: {len(flipped)}" + ("" if before == "OK" else ", would be released")
            )
            scores = [(flip.name, _score(flip.worst_before), _score(flip.worst_now)) for flip in flipped]
            lines += [f"    {name}: highest score {worst} to {new}" for name, worst, new in scores]
        others = [flip for flip in self.flips if Verdict.ERROR in (flip.before, flip.now)]
        lines += [f"  {flip.name}: {flip.before} to {flip.now}" for flip in others]
        if self.same_judge:
            alike = self.same_judge - len(self.not_alike)
            lines.append(
                f"same networks, limits and settings: {self.same_judge}, of which {alike} agree bit for bit"
            )
        return lines


def compare(sources: Sequence[Source], results: Mapping[str, Replayed], judge: Provenance) -> Comparison:
    """Compare the results of frames from an archive with their records."""
    same, not_alike, flips, problems, compared = 0, [], [], [], 0
    for source in sources:
        if source.archive is None or source.row is None:
            continue
        record, problem = read_record(source.archive, source.row)
        if record is not None and problem is None:
            problem = _scale_problem(record.provenance.um_per_px, judge.um_per_px)
        if record is None or problem is not None:
            problems.append(f"{source.path.parent / Path(source.row.record_file).name}: {problem}")
            continue
        before, now = record.inspection, results[source.name]
        compared += 1
        if _judged_by(record.provenance) == _judged_by(judge) and before.verdict is not Verdict.ERROR:
            same += 1
            found = before.verdict, before.nok_scores, before.findings
            if found != (now.verdict, now.scores, now.findings):
                not_alike.append(source.name)
        if before.verdict is not now.verdict:
            flips.append(
                Flip(
                    name=source.name,
                    before=before.verdict,
                    now=now.verdict,
                    worst_before=before.worst,
                    worst_now=now.worst,
                )
            )
    return Comparison(
        compared=compared,
        same_judge=same,
        not_alike=tuple(not_alike),
        flips=tuple(flips),
        problems=tuple(problems),
    )


def _scale_problem(taken_um_per_px: float, judged_um_per_px: float) -> str | None:
    if taken_um_per_px == judged_um_per_px:
        return None
    return (
        f"taken at {taken_um_per_px:g} µm/px, but judged as {judged_um_per_px:g} µm/px; "
        "judge it again at the scale at which it was taken"
    )


def _judged_by(provenance: Provenance) -> tuple[object, ...]:
    networks = (provenance.model_hash, provenance.ring_model_hash, provenance.seen_model_hash)
    return *networks, provenance.thresholds, provenance.limits_hash


def _score(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"
