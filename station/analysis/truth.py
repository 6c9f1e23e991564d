"""What the parts really were, where somebody knows it; and both kinds of error against it."""

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from station.errors import RecordError

VERDICTS = ("OK", "NOK")
HINT = 'a CSV with the columns name and verdict, or JSON {"name": "OK"}, is needed; verdicts are OK and NOK'


@dataclass(frozen=True, slots=True)
class Errors:
    """Judged parts whose truth is known."""

    ok: int
    """Truly OK."""
    nok: int
    escapes: tuple[str, ...]
    """NOK parts that were judged OK."""
    false_rejects: tuple[str, ...]
    """OK parts that were judged NOK."""
    not_judged: tuple[str, ...]


def errors(truth: Mapping[str, str], said: Mapping[str, str]) -> Errors:
    """`said`: verdict of each name; names without a truth do not count."""
    known = {name: (truth[name], verdict) for name, verdict in said.items() if name in truth}
    return Errors(
        sum(true == "OK" for true, _ in known.values()),
        sum(true == "NOK" for true, _ in known.values()),
        tuple(name for name, pair in known.items() if pair == ("NOK", "OK")),
        tuple(name for name, pair in known.items() if pair == ("OK", "NOK")),
        tuple(name for name, (_, verdict) in known.items() if verdict not in VERDICTS),
    )


def interval(hits: int, trials: int) -> tuple[float, float]:
    """95 % confidence interval of a share (Clopper and Pearson, 1934); (0, 1) without trials."""
    from scipy.stats import binomtest  # takes most of a second, which the window's start would have

    if not trials:
        return 0.0, 1.0
    found = binomtest(hits, trials).proportion_ci(0.95, method="exact")
    return float(found.low), float(found.high)


def read_truth(path: Path) -> dict[str, str]:
    """Verdict of each name: a serial, or the name of a file. Raises RecordError."""
    try:
        text = path.read_text(encoding="utf-8-sig")
        pairs = _of_json(text) if path.suffix.lower() == ".json" else _of_csv(text)
    except OSError as error:
        raise RecordError(f"{path}: cannot be read ({error.strerror})") from None
    except (ValueError, KeyError, TypeError, AttributeError):
        raise RecordError(f"{path}: {HINT}") from None
    truth: dict[str, str] = {}
    for name, verdict in pairs:
        if verdict not in VERDICTS:
            raise RecordError(f"{path}: {name!r} is {verdict!r}; {HINT}")
        if truth.setdefault(name, verdict) != verdict:
            raise RecordError(f"{path}: {name!r} is said to be OK and NOK")
    if not truth:
        raise RecordError(f"{path}: holds no parts; {HINT}")
    return truth


def _of_json(text: str) -> list[tuple[str, str]]:
    return [(str(name), str(verdict)) for name, verdict in json.loads(text).items()]


def _of_csv(text: str) -> list[tuple[str, str]]:
    return [(row["name"], row["verdict"]) for row in csv.DictReader(text.splitlines())]
