"""Numbers of messages tell how many are missing, and of which topic where each topic counts by itself."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from space_robot_msgs_py.log.numbering import ANY_TOPIC, Numbering

TOPICS = {1: "/a", 2: "/b", 7: "/c"}


def taken(messages: list[tuple[int, int]], *, from_zero: bool) -> Numbering:
    """A numbering that has seen these (channel, number)."""
    numbering = Numbering(from_zero=from_zero)
    for channel, number in messages:
        numbering.take(channel, TOPICS[channel], number)
    return numbering


@pytest.mark.parametrize("from_zero", [True, False])
@pytest.mark.parametrize("seed", range(10))
def test_what_is_missing_of_each_topic_is_counted(seed: int, from_zero: bool) -> None:
    """Every number between its first and its last one that is not there; of topics that begin at 0, from there on."""
    rng = np.random.default_rng(seed)
    sent = [(channel, number + (0 if from_zero else 100 * channel)) for number in range(30) for channel in TOPICS]
    kept = [one for one in sent if rng.random() < 0.8]
    lost: Counter[str] = Counter()
    for channel, topic in TOPICS.items():
        numbers = [number for one, number in kept if one == channel]
        lost[topic] = numbers[-1] + 1 - (0 if from_zero else numbers[0]) - len(numbers)
    numbering = taken(kept, from_zero=from_zero)
    assert numbering.lost() == lost
    assert numbering.kept() == Counter(TOPICS[channel] for channel, _ in kept)


def test_one_count_over_the_file_does_not_tell_the_topic() -> None:
    """A number that rises from message to message over several topics is one count; over one topic it is its own."""
    rising = [(1, 5), (2, 6), (1, 9), (7, 12)]
    assert taken(rising, from_zero=False).lost() == Counter({ANY_TOPIC: 4})
    assert taken([(1, 5), (1, 9)], from_zero=False).lost() == Counter({"/a": 3})
    assert taken(rising, from_zero=True).lost() == Counter({"/a": 8, "/b": 6, "/c": 12})
    # Equal numbers are counts of their own.
    assert taken([(1, 5), (2, 5), (1, 7), (2, 8)], from_zero=False).lost() == Counter({"/a": 1, "/b": 2})


def test_files_without_numbers_have_no_gaps() -> None:
    """All zero, or a number that falls, is no loss; nothing read is none either."""
    for messages in ([(1, 0)] * 5, [(1, 0), (2, 0), (1, 0)], [(1, 9), (1, 3)], []):
        assert not +taken(messages, from_zero=False).lost()
    for messages in ([(1, 0)] * 5, [(1, 0), (2, 0), (1, 0)], []):
        assert not +taken(messages, from_zero=True).lost()


def test_channels_of_one_topic_count_together() -> None:
    """Each channel has its numbers; what is kept and missing is that of the topic."""
    numbering = Numbering(from_zero=True)
    for channel in (1, 2):
        numbering.take(channel, "/a", 1)
    assert (numbering.kept(), numbering.lost()) == (Counter({"/a": 2}), Counter({"/a": 2}))
