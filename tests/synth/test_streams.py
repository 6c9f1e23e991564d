"""Random streams: named, apart from each other, and the same in any order."""

from dataclasses import fields
from itertools import permutations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from synth.part.part import draw_part
from synth.part.streams import Stream, stream
from synth.recipes.named import WIDE

GROUPS = ("pose", "bead", "joint", "relief", "surface", "dirt", "light", "sensor")


@given(st.integers(0, 2**31))
def test_no_two_streams_are_alike(seed: int) -> None:
    first = {name: stream(seed, name).random() for name in Stream}
    assert len(set(first.values())) == len(Stream)
    assert stream(seed, Stream.BEAD).random() == first[Stream.BEAD]


@given(st.integers(0, 10**6), st.text(min_size=1, max_size=12), st.text(min_size=1, max_size=12))
def test_a_stream_splits_by_name_and_number(seed: int, one: str, other: str) -> None:
    draws = [stream(seed, Stream.DEFECTS, key).random() for key in (one, other, 7, 8)]
    assert (draws[0] == draws[1]) == (one == other)
    assert draws[2] != draws[3]


@given(st.integers(0, 10**6), st.sampled_from(list(permutations(GROUPS))[::997]))
def test_groups_are_drawn_alike_in_any_order(seed: int, order: tuple[str, ...]) -> None:
    part = draw_part(seed, WIDE)
    found = {name: getattr(WIDE, name).draw(stream(seed, Stream[name.upper()])) for name in order}
    assert found == {name: getattr(part, name) for name in GROUPS}


def test_every_group_of_the_recipe_has_its_own_stream() -> None:
    assert {field.name for field in fields(WIDE)} - {"ok_weight", "defects"} == set(GROUPS)
    assert len({int(Stream[name.upper()]) for name in GROUPS}) == len(GROUPS)


def test_what_is_drawn_of_a_group_does_not_depend_on_the_others() -> None:
    usual = draw_part(5, WIDE)
    draws = np.random.default_rng(0)
    for name in GROUPS:
        changed = getattr(WIDE, name).draw(draws)
        assert changed != getattr(usual, name)
    assert usual == draw_part(5, WIDE)
