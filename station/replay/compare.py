"""Two judgements of the same parts: which verdicts flip, both ways."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from station.archive.reader import read_record
from station.domain import Verdict
from station.records import Provenance, Record
from station.replay.files import Source


@dataclass(frozen=True, slots=True)
class Flip:
    """A part that is judged otherwise now."""

    name: str
    before: str
    now: str
    worst_before: float | None
    worst_now: float | None


@dataclass(frozen=True, slots=True)
class Comparison:
    """What the line said against what is said now."""

    compared: int
    same_judge: int
    """Records made with the same networks, limits and settings: these must agree to the bit."""
    not_alike: tuple[str, ...]
    """Of these, the ones that do not."""
    flips: tuple[Flip, ...]
    problems: tuple[str, ...]
    """Records that cannot be read, or whose frame is not the recorded one: not compared."""

    def lines(self) -> list[str]:
        """For people."""
        answer = [f"compared with the line: {self.compared} parts, {len(self.flips)} verdicts flip"]
        for before, now in (("NOK", "OK"), ("OK", "NOK")):
            flipped = [f for f in self.flips if (f.before, f.now) == (before, now)]
            answer.append(f"  {before} to {now}: {len(flipped)}" + ("" if before == "OK" else ", would be released"))
            answer += [f"    {f.name}: worst score {_score(f.worst_before)} to {_score(f.worst_now)}" for f in flipped]
        others = [f for f in self.flips if "ERROR" in (f.before, f.now)]
        answer += [f"  {f.name}: {f.before} to {f.now}" for f in others]
        if self.same_judge:
            alike = self.same_judge - len(self.not_alike)
            answer.append(f"same networks, limits and settings: {self.same_judge}, of which {alike} agree to the bit")
        return answer


def compare(sources: Sequence[Source], entries: Mapping[str, dict[str, Any]], judge: Provenance) -> Comparison:
    """Entries of frames that come from an archive against their records."""
    same, not_alike, flips, problems, compared = 0, [], [], [], 0
    for source in sources:
        if source.row is None:
            continue
        record, problem = _record(source)
        if record is None or problem is not None:
            problems.append(f"{source.path.parent / Path(source.row.record_file).name}: {problem}")
            continue
        now = entries[source.name]
        compared += 1
        scores, again = [s.nok for s in record.inspection.scores], [s for s in now["segments"] if s is not None]
        if _who(record.provenance) == _who(judge) and record.verdict is not Verdict.ERROR:
            same += 1
            found = [{**asdict(f), "kind": str(f.kind)} for f in record.inspection.findings]
            if scores != again or found != now["findings"] or str(record.verdict) != now["verdict"]:
                not_alike.append(source.name)
        if str(record.verdict) != now["verdict"]:
            worst = (max(scores, default=None), max(again, default=None))
            flips.append(Flip(source.name, str(record.verdict), now["verdict"], *worst))
    return Comparison(compared, same, tuple(not_alike), tuple(flips), tuple(problems))


def _record(source: Source) -> tuple[Record | None, str | None]:
    if source.row is None:
        return None, "belongs to no record"
    return read_record(Path(str(source.path)[: -len(str(source.row.frame_file))]), source.row)


def _who(p: Provenance) -> tuple[object, ...]:
    return p.model_hash, p.ring_model_hash, p.thresholds, p.limits_hash


def _score(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"
