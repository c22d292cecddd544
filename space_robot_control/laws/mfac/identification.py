"""The first seconds of a run that Phi(1) is learned in: excitation, and the response that it shows."""

from __future__ import annotations

from collections import deque

import numpy as np

from space_robot_control.channels import Channels
from space_robot_control.laws.mfac.gains import MfacGains
from space_robot_control.laws.mfac.initial_value import Pulses, Push, Response, ResponseFit
from space_robot_description.spec import expand
from space_robot_msgs_py.interfaces import Vector


class Identification:
    """Pushes or pulses, and the fit of what the outputs do; takes no time where Phi(1) is the nominal one.

    Args:
        gains: of the law.
        channels: of the law.
        limit: (m,) of the inputs [N, N m].
        period: control period [s].
        delay: periods by which commands act late.
    """

    def __init__(self, gains: MfacGains, channels: Channels, limit: Vector, period: float, delay: int) -> None:
        initial, self._size, self._delay = gains.initial, channels.size, delay
        ticks = max(1, round(initial.seconds / period))
        level = limit * expand(initial.level, channels.names, "controller.gains.initial.level")
        self._excitation: Push | Pulses | None = None
        if initial.source != "nominal":
            pulses = initial.source == "pulses"
            self._excitation = Pulses(max(1, ticks // 4), level) if pulses else Push(ticks, level)
        self._fit = ResponseFit(period, channels.size, diagonal=initial.source == "push")
        self._trust = initial.trust
        self.reset()

    @property
    def ticks(self) -> int:
        """Control periods it takes."""
        return 0 if self._excitation is None else self._excitation.ticks

    def reset(self) -> None:
        """Forget all samples."""
        zero = np.zeros(self._size)
        self._fit.reset()
        self._moved = zero
        # Inputs that do not act yet, the oldest first.
        self._waiting = deque([zero] * self._delay)

    def inputs(self, tick: int, start: Vector, moved: Vector) -> Vector:
        """Return the inputs (m,) of a tick [N, N m].

        Args:
            tick: counted from the first one.
            start: (m,) error at the first tick.
            moved: (m,) own motion since the last tick.
        """
        assert self._excitation is not None
        self._moved = self._moved + moved
        inputs = self._excitation.at(tick, start)
        self._waiting.append(inputs)
        self._fit.add(self._moved, self._waiting.popleft())
        return inputs

    def response(self, nominal: Vector) -> tuple[Vector, Vector]:
        """Return B (m, m) and the relative deviation (m,) of its diagonal: the nominal one where none was learned."""
        if self._excitation is None:
            return nominal, np.zeros(self._size)
        return _trusted(self._fit.solve(), nominal, self._trust)


def _trusted(found: Response, nominal: Vector, trust: float) -> tuple[Vector, Vector]:
    """The fitted response where every diagonal entry is well enough known and positive, else the nominal one."""
    relative = found.relative
    if (relative <= trust).all() and (np.diag(found.gain) > 0.0).all():
        return found.gain, relative
    return nominal, np.minimum(relative, 1e6)
