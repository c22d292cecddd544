import pytest
from hypothesis import given
from hypothesis import strategies as st

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.joiner import StampJoiner

stamps_and_orders = st.integers(1, 6).flatmap(
    lambda count: st.tuples(
        st.just(count),
        st.permutations([(part, stamp) for part in range(3) for stamp in range(count)]),
        st.lists(st.tuples(st.integers(0, 2), st.integers(0, count - 1)), max_size=8),
        st.randoms(use_true_random=False),
    )
)


@given(case=stamps_and_orders)
def test_every_stamp_comes_out_whole_and_once(case):
    """Whatever the order of arrival, and with duplicates anywhere, each stamp is given out exactly once, complete."""
    count, arrivals, duplicates, random = case
    for duplicate in duplicates:
        # Behind the first arrival of the same part: a duplicate repeats something.
        first = arrivals.index(duplicate)
        arrivals.insert(random.randint(first + 1, len(arrivals)), duplicate)
    joiner = StampJoiner(3, count)
    given_out = {}
    for part, stamp in arrivals:
        whole = joiner.add(part, stamp, (part, stamp))
        if whole is not None:
            assert stamp not in given_out
            given_out[stamp] = whole
    assert given_out == {stamp: tuple((part, stamp) for part in range(3)) for stamp in range(count)}
    assert (len(joiner), joiner.dropped) == (0, 0)


def test_the_first_of_two_duplicates_counts():
    """A part that comes twice before its stamp is complete keeps its first item."""
    joiner = StampJoiner(2, 4)
    assert joiner.add(0, 1, "first") is None
    assert joiner.add(0, 1, "second") is None
    assert joiner.add(1, 1, "other") == ("first", "other")


def test_the_stamp_that_waits_longest_is_dropped_and_counted():
    """Beyond the capacity the oldest incomplete stamp goes; the others stay."""
    joiner = StampJoiner(2, 3)
    for stamp in range(5):
        assert joiner.add(0, stamp, stamp) is None
    assert (len(joiner), joiner.dropped) == (3, 2)
    assert [joiner.add(1, stamp, stamp) for stamp in (2, 3, 4)] == [(2, 2), (3, 3), (4, 4)]
    assert joiner.add(1, 0, 0) is None


def test_a_full_joiner_still_completes():
    """The part that completes a stamp never pushes one out."""
    joiner = StampJoiner(2, 1)
    joiner.add(0, 1, "a")
    assert joiner.add(1, 1, "b") == ("a", "b")
    assert joiner.dropped == 0


def test_clear_lets_time_start_again():
    """After clear a stamp that was given out is given out again; without it, it is not."""
    joiner = StampJoiner(1, 5)
    assert joiner.add(0, 0, "a") == ("a",)
    assert joiner.add(0, 0, "a") is None
    joiner.clear()
    assert joiner.add(0, 0, "b") == ("b",)


def test_without_memory_time_may_start_again():
    """With once=False a complete stamp is forgotten at once, and parts that overtook the restart are kept."""
    joiner = StampJoiner(2, 5, once=False)
    for _ in range(2):
        assert joiner.add(1, 0, "reference") is None
        assert joiner.add(0, 0, "state") == ("state", "reference")


def test_a_joiner_of_one_part_gives_every_arrival():
    """With a single part every first arrival is given out at once."""
    assert StampJoiner(1, 1).add(0, 7, None) == (None,)


@pytest.mark.parametrize(("parts", "capacity"), [(0, 1), (1, 0), (-1, 5)])
def test_a_joiner_without_parts_or_room_is_refused(parts, capacity):
    """A joiner without parts or room is a SpecError that says what it was to be."""
    said = rf"parts, capacity: nothing to join; got \({parts}, {capacity}\); accepted: 1 or more"
    with pytest.raises(SpecError, match=said):
        StampJoiner(parts, capacity)


def test_what_waits_for_later_stamps_may_give_way_once():
    """The next item of that part and stamp takes its place, whatever ``choose`` says; other parts and stamps stay."""
    joiner = StampJoiner(2, 8, choose=lambda index, there, new: there)
    for stamp in (0, 1, 2):
        joiner.add(0, stamp, f"old {stamp}")
    joiner.let_give_way(0, 1)
    joiner.add(0, 1, "new 1")
    joiner.add(0, 2, "new 2")
    joiner.add(0, 2, "newer 2")
    assert [joiner.add(1, stamp, "x") for stamp in (0, 1, 2)] == [("old 0", "x"), ("old 1", "x"), ("new 2", "x")]


def test_what_gave_way_to_nothing_does_so_no_more_when_its_stamp_is_complete() -> None:
    """Of a stamp that comes again, as after a restart, the first item counts as ever."""
    joiner = StampJoiner(2, 8, once=False)
    joiner.add(0, 3, "old")
    joiner.let_give_way(0, 2)
    assert joiner.add(1, 3, "x") == ("old", "x")
    joiner.add(0, 3, "first")
    joiner.add(0, 3, "second")
    assert joiner.add(1, 3, "y") == ("first", "y")


def test_a_choice_is_made_of_two_items_of_one_part() -> None:
    """It is given the part, what is there and what comes; what it keeps may be replaced again."""
    asked = []

    def choose(part: int, there: str, new: str) -> str:
        asked.append((part, there, new))
        return max(there, new)

    joiner = StampJoiner(2, 8, choose=choose)
    for item in ("b", "a", "c"):
        assert joiner.add(1, 5, item) is None
    assert joiner.add(0, 5, "x") == ("x", "c")
    assert asked == [(1, "b", "a"), (1, "b", "c")]


def test_the_last_stamps_given_out_are_remembered() -> None:
    """As many as there is room for: a duplicate of an older one is taken for new."""
    joiner = StampJoiner(1, 3)
    for stamp in range(4):
        assert joiner.add(0, stamp, stamp) == (stamp,)
    assert [joiner.add(0, stamp, "again") for stamp in (1, 2, 3)] == [None] * 3
    assert joiner.add(0, 0, "again") == ("again",)


def test_a_clear_forgets_what_is_under_way_and_what_gives_way() -> None:
    """What waits is gone and not counted as dropped."""
    joiner = StampJoiner(2, 3)
    joiner.add(0, 1, "old")
    joiner.let_give_way(0, 0)
    joiner.clear()
    assert (len(joiner), joiner.dropped) == (0, 0)
    joiner.add(0, 1, "first")
    joiner.add(0, 1, "second")
    assert joiner.add(1, 1, "x") == ("first", "x")
