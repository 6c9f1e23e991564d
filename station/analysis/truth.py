"""Compares verdicts with the truth, where it is known: escapes and false rejects."""

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from station.errors import RecordError
from station.numbers import without_twins

VERDICTS = ("OK", "NOK")
"""Verdicts that a truth can have."""
HINT = 'give a CSV with the columns name and verdict, or JSON {"name": "OK"}; verdicts are OK and NOK'


@dataclass(frozen=True, slots=True, kw_only=True)
class Errors:
    """Errors among the parts whose truth is known."""

    ok: int
    """Number of parts that are truly OK."""
    nok: int
    """Number of parts that are truly NOK."""
    escapes: tuple[str, ...]
    """Names of the NOK parts that were judged OK."""
    false_rejects: tuple[str, ...]
    """Names of the OK parts that were judged NOK."""
    not_judged: tuple[str, ...]
    """Names of the parts that were not judged."""


def errors(truth: Mapping[str, str], verdicts: Mapping[str, str]) -> Errors:
    """Return the errors of verdicts by name; names without a truth do not count."""
    known = {name: (truth[name], verdict) for name, verdict in verdicts.items() if name in truth}
    return Errors(
        ok=sum(true == "OK" for true, _ in known.values()),
        nok=sum(true == "NOK" for true, _ in known.values()),
        escapes=tuple(name for name, pair in known.items() if pair == ("NOK", "OK")),
        false_rejects=tuple(name for name, pair in known.items() if pair == ("OK", "NOK")),
        not_judged=tuple(name for name, (_, verdict) in known.items() if verdict not in VERDICTS),
    )


def interval(hits: int, trials: int) -> tuple[float, float]:
    """Return the 95 % confidence interval (Clopper and Pearson, 1934) of a fraction; (0, 1) if no trials."""
    from scipy.stats import (
        binomtest,
    )  # imported here: it takes most of a second, and the window must start fast

    if not trials:
        return 0.0, 1.0
    found = binomtest(hits, trials).proportion_ci(0.95, method="exact")
    return float(found.low), float(found.high)


def read_truth(path: Path) -> dict[str, str]:
    """Return the true verdict of each name, which is a serial or a file name. Raises RecordError."""
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
            raise RecordError(f"{path}: conflicting truth for {name!r}: both OK and NOK; remove one of them")
    if not truth:
        raise RecordError(f"{path}: contains no parts; {HINT}")
    return truth


def _of_json(text: str) -> list[tuple[str, str]]:
    return [
        (str(name), str(verdict))
        for name, verdict in json.loads(text, object_pairs_hook=without_twins).items()
    ]


def _of_csv(text: str) -> list[tuple[str, str]]:
    return [(row["name"], row["verdict"]) for row in csv.DictReader(text.splitlines())]
