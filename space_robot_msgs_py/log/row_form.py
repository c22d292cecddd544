"""The records of a row of messages, put together at once: what rows of the same sizes have in common is made once."""

from __future__ import annotations

from collections.abc import MutableMapping, Sequence
from struct import Struct

from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.log.mcap.positions import Shape
from space_robot_msgs_py.log.mcap.records import message_head_bytes

# Sequence number and both times of a record; opcode, length and channel stand before them.
TIMES = Struct("<IQQ")
# Forms that are kept; the messages of nearly all rows of a log have the same sizes.
MAX_FORMS = 64
# The size of a message that is not there.
NONE = -1


class RowForm:
    """Rows whose messages have these sizes.

    Args:
        channels: of the columns of a row.
        sizes: of the messages in them [bytes], or ``NONE``.

    Attributes:
        columns: those that have a message.
        shape: of the records.
    """

    def __init__(self, channels: Sequence[int], sizes: Sequence[int]) -> None:
        self.columns = [column for column, size in enumerate(sizes) if size != NONE]
        self.shape = Shape([(channels[column], sizes[column]) for column in self.columns])
        self._pieces = [b""] * (3 * len(self.columns))
        self._pieces[::3] = [head_of(channels[column], sizes[column]) for column in self.columns]

    def records(self, stamp: int, numbers: Sequence[int], row: Sequence[bytes | None]) -> bytes:
        """The records of a row.

        Args:
            stamp: of its messages [ns].
            numbers: of each message that is there, on its channel.
            row: of this form.
        """
        pieces, number = self._pieces.copy(), numbers[0] if numbers else 0
        if numbers.count(number) == len(numbers):
            pieces[1::3] = [TIMES.pack(number, stamp, stamp)] * len(numbers)
        else:
            pieces[1::3] = [TIMES.pack(one, stamp, stamp) for one in numbers]
        pieces[2::3] = [row[column] or b"" for column in self.columns]
        return b"".join(pieces)


class Rows:
    """Makes the records of rows and counts their messages.

    Args:
        names: topics of the columns of a row.
        channels: of the columns.
        counts: messages so far by topic, for those that the log has channels of; kept up to date.
        key: of the log, for errors.
    """

    def __init__(
        self, names: Sequence[str], channels: Sequence[int], counts: MutableMapping[str, int], key: str
    ) -> None:
        self._names, self._channels, self._counts, self._key = names, channels, counts, key
        self._forms: dict[tuple[int, ...], RowForm] = {}

    def form(self, sizes: tuple[int, ...]) -> RowForm:
        """The form of rows with messages of these sizes.

        Raises:
            LogError: the log has no channel for one of them.
        """
        form = self._forms.get(sizes)
        if form is None:
            form = RowForm(self._channels, sizes)
            for column in form.columns:
                if self._names[column] not in self._counts:
                    raise LogError("its header names no such topic", key=self._key, value=self._names[column])
            if len(self._forms) >= MAX_FORMS:
                self._forms.clear()
            self._forms[sizes] = form
        return form

    def records(self, stamp: int, row: Sequence[bytes | None], form: RowForm) -> bytes:
        """The records of a row of a form, which are counted; see ``RowForm.records``."""
        counts, names = self._counts, [self._names[column] for column in form.columns]
        numbers = [counts[name] for name in names]
        self.count(names)
        return form.records(stamp, numbers, row)

    def count(self, names: Sequence[str]) -> None:
        """One message more on each of these topics."""
        for name in names:
            self._counts[name] += 1


def sizes_of(row: Sequence[bytes | None]) -> tuple[int, ...]:
    """Of the messages of a row [bytes]; ``NONE`` where there is none."""
    return tuple([NONE if data is None else len(data) for data in row])


def head_of(channel: int, size: int) -> bytes:
    """What stands in front of number and times of a record whose message has so many bytes."""
    return message_head_bytes(channel, 0, 0, size)[: -TIMES.size]
