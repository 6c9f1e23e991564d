"""Words for the purposes of a part: the window says "master", records and registers say "golden"."""

from station.domain import Purpose

PURPOSE_WORDS: dict[str, str] = {Purpose.PART: "part", Purpose.GOLDEN: "master", Purpose.TEST: "test image"}
"""Word for each purpose; the window translates it."""
