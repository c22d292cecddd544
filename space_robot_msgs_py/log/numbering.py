"""What the numbers of the messages of an MCAP file say of messages that are no longer in it."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

# Numbers that count over all topics of a file tell that messages are missing, and not of which.
ANY_TOPIC = "topics not known"


@dataclass(slots=True)
class _Counter:
    first: int
    last: int
    count: int = 1

    @property
    def lost(self) -> int:
        """Numbers that none of the messages has; files without numbers have no gaps."""
        return max(0, self.last - self.first + 1 - self.count)


class Numbering:
    """Follows the numbers of one file.

    Args:
        from_zero: every topic counts from 0; other tools may begin anywhere.
    """

    def __init__(self, *, from_zero: bool) -> None:
        self._from_zero = from_zero
        self._channels: dict[int, tuple[str, _Counter]] = {}
        self._file: _Counter | None = None
        self._rises = True

    def take(self, channel: int, topic: str, sequence: int) -> None:
        """The next message of the file."""
        _, one = self._channels.setdefault(channel, (topic, self._begin(sequence)))
        one.last, one.count = sequence, one.count + 1
        if self._file is None:
            self._file = _Counter(sequence, sequence)
        else:
            self._rises = self._rises and sequence > self._file.last
            self._file.last, self._file.count = sequence, self._file.count + 1

    def kept(self) -> Counter[str]:
        """Messages that were read, by topic."""
        found: Counter[str] = Counter()
        for topic, one in self._channels.values():
            found[topic] += one.count
        return found

    def lost(self) -> Counter[str]:
        """Messages that are missing, by topic, or as ``ANY_TOPIC``.

        A number that rises from message to message, whatever their topics, is one counter over the file.
        """
        if self._rises and len(self._channels) > 1 and self._file is not None and not self._from_zero:
            return Counter({ANY_TOPIC: self._file.lost})
        found: Counter[str] = Counter()
        for topic, one in self._channels.values():
            found[topic] += one.lost
        return found

    def _begin(self, sequence: int) -> _Counter:
        return _Counter(0 if self._from_zero else sequence, sequence, 0)
