"""Measures a run from its ticks alone, while they come in: of a tick a few numbers are kept, not its messages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice

import numpy as np
import numpy.typing as npt

from space_robot_bringup.judge.metrics import Axis, Matrix, RunMetrics, axis_names, deviations
from space_robot_msgs_py.errors import LayoutError, NonFiniteError
from space_robot_msgs_py.interfaces import NANOSECONDS, Tick, Vector
from space_robot_msgs_py.kernel.products import dot
from space_robot_msgs_py.log.arrays import stack_telemetry
from space_robot_msgs_py.log.blocks import BLOCK

SETTLING_BAND = 0.02
STILL = 1e-9
MOVED = 1e-6
# Not every plant estimates it, and older logs do not have it.
INTEGRATION_ERROR = "integration_error"
PEAKS = ("momentum_residual", "energy_residual", "quaternion_residual", "joint_limit")
# Stamps [ns] of K ticks, plant telemetry by label, desired configurations and velocities.
Block = tuple[npt.NDArray[np.int64], Mapping[str, Matrix], Matrix, Matrix]
PLANT_BLOCKS = ("true_configuration", "saturation", "applied_wrench", "applied_effort", *PEAKS)


def tick_blocks(ticks: Iterable[Tick]) -> Iterator[Block]:
    """What ``Measurement.add`` takes, of ticks in memory.

    Raises:
        LayoutError: a block of the plant's telemetry is missing, or its layout changes.
    """
    left, first = iter(ticks), None
    while rows := list(islice(left, BLOCK)):
        telemetry = [tick.sample.telemetry for tick in rows]
        first = telemetry[0] if first is None else first
        # With the first of all in front, which has to have the same layout.
        plant = stack_telemetry([first, *telemetry], PLANT_BLOCKS)
        yield (
            np.array([tick.stamp for tick in rows], dtype=np.int64),
            {label: block[1:] for label, block in plant.items()},
            np.array([tick.reference.q for tick in rows]),
            np.array([tick.reference.v for tick in rows]),
        )


class Measurement:
    """Takes the ticks of a run in blocks of any sizes, which change no bit of the result.

    Extremes are updated block by block. What an axis settles around is known at the end, and sums round as they do over
    the run as a whole; so stamp, true configuration, squared errors and torque of every tick are kept: 200 bytes of a
    robot with four joints, a fiftieth of its messages.

    Args:
        joint_names: for the names of axes.
        base_translation: also judge the base position (free-flying).
        prismatic: (n) True where a joint is a length; empty: all are angles.
        bands: axis to the half width of its settling band [deg or m], instead of 2 % of its travel.
    """

    def __init__(
        self,
        joint_names: Sequence[str],
        *,
        base_translation: bool,
        prismatic: Sequence[bool] = (),
        bands: Mapping[str, float] | None = None,
    ) -> None:
        self._first = 0 if base_translation else 3
        self._names = axis_names(joint_names, base_translation=base_translation)
        lengths = [True] * 3 + [False] * 3 + list(prismatic or [False] * len(joint_names))
        self._lengths = lengths[self._first :]
        self._scale = np.where(self._lengths, 1.0, np.degrees(1.0))
        self._bands, n = bands or {}, len(joint_names)
        self._sizes = {"true_configuration": 7 + n, "reference.q": 7 + n, "reference.v": 6 + n, "saturation": 6 + n}
        self._sizes |= {"applied_wrench": 6, "applied_effort": n}
        self._stamps: list[npt.NDArray[np.int64]] = []
        self._truth: list[Matrix] = []
        self._squares: list[Matrix] = []
        self._torque: list[Vector] = []
        self._largest_error, self._last_error = np.zeros(len(self._names)), np.zeros(len(self._names))
        self._peaks = dict.fromkeys(PEAKS, 0.0)
        self._integration_error: float | None = None
        self._saturated = self._saturated_first = 0
        self._goal: Vector = np.empty(0)
        self._moving = False

    @property
    def stamps(self) -> npt.NDArray[np.int64]:
        """Of the ticks so far [ns]."""
        return np.concatenate([np.empty(0, dtype=np.int64), *self._stamps])

    def add(self, stamp: npt.NDArray[np.int64], plant: Mapping[str, Matrix], q_d: Matrix, v_d: Matrix) -> None:
        """Take the next ticks, at least one.

        Args:
            stamp: (K,) [ns].
            plant: telemetry of the plant by label, (K, size).
            q_d: (K, 7+n) desired configuration.
            v_d: (K, 6+n) desired velocity.

        Raises:
            LayoutError: a block of the plant's telemetry is missing, or something is of another robot.
        """
        if missing := [label for label in PLANT_BLOCKS if label not in plant]:
            raise LayoutError("no such block", key="telemetry", value=missing[0], accepted=", ".join(plant))
        self._check_sizes({**plant, "reference.q": q_d, "reference.v": v_d})
        # A copy: the columns of a block keep the whole block.
        truth = np.array(plant["true_configuration"])
        errors = self._scaled(deviations(truth, q_d))
        self._largest_error = np.maximum(self._largest_error, np.abs(errors).max(axis=1))
        self._last_error, self._goal = np.abs(errors[:, -1]), np.array(q_d[-1])
        self._moving = bool(np.abs(v_d[-1]).max() > STILL)
        for name in PEAKS:
            self._peaks[name] = float(np.maximum(self._peaks[name], np.max(np.abs(plant[name]), initial=0.0)))
        if INTEGRATION_ERROR in plant:
            self._integration_error = max(self._integration_error or 0.0, float(np.max(plant[INTEGRATION_ERROR])))
        saturated = plant["saturation"].max(axis=1, initial=0.0) > 0.0
        self._saturated_first = self._saturated_first if self._stamps else int(saturated[0])
        self._saturated += int(np.count_nonzero(saturated))
        torque = np.abs(plant["applied_wrench"][:, 3:]).sum(axis=1) + np.abs(plant["applied_effort"]).sum(axis=1)
        self._stamps.append(np.array(stamp))
        self._truth.append(truth)
        self._squares.append(errors**2)
        self._torque.append(torque)

    def _check_sizes(self, blocks: Mapping[str, Matrix]) -> None:
        for label, size in self._sizes.items():
            if blocks[label].shape[1] != size:
                accepted = f"{size} numbers"
                raise LayoutError("of another robot", key=label, value=blocks[label].shape[1], accepted=accepted)

    def result(self) -> RunMetrics:
        """The judged run.

        Raises:
            NonFiniteError: there is no tick, or a number is not finite.
        """
        if not self._stamps:
            raise NonFiniteError(
                "a run without a complete tick cannot be judged", key="ticks", value=0, accepted="at least 1"
            )
        time = self.stamps / NANOSECONDS
        metrics = RunMetrics(
            ticks=time.size,
            simulated_time=float(time[-1] - time[0]),
            axes=tuple(self._axes(time)),
            saturation_share=self._saturation_share(time.size),
            effort_integral=dot(np.concatenate(self._torque), np.diff(time, prepend=time[0])),
            integration_error=self._integration_error,
            **self._peaks,
        )
        for key, value in metrics.flat().items():
            if value is not None and not np.isfinite(value):
                raise NonFiniteError("a metric is not finite", key=key, value=value, accepted="a finite number")
        return metrics

    def _scaled(self, errors: Matrix) -> Matrix:
        """(axes, K): those of the judged axes, each in one piece, in the unit it is shown in."""
        return np.ascontiguousarray(errors[:, self._first :].T) * self._scale[:, None]

    def _saturation_share(self, ticks: int) -> float:
        """Of periods: the first tick ends none."""
        if ticks == 1:
            return float(self._saturated)
        return (self._saturated - self._saturated_first) / (ticks - 1)

    def _axes(self, time: Vector) -> Iterator[Axis]:
        ways = [_Way(self._bands.get(name)) for name in self._names]
        for truth in self._truth:
            from_goal = self._scaled(deviations(truth, np.repeat(self._goal[None], len(truth), axis=0)))
            for way, distances in zip(ways, from_goal, strict=True):
                way.add(distances)
        for i, way in enumerate(ways):
            moved = way.travel > MOVED and not self._moving
            yield Axis(
                name=self._names[i],
                unit="m" if self._lengths[i] else "deg",
                travel=float(way.travel),
                final_error=float(self._last_error[i]),
                max_error=float(self._largest_error[i]),
                rms_error=float(np.sqrt(np.mean(np.concatenate([squares[i] for squares in self._squares])))),
                settling_time=way.settling_time(time) if moved else None,
                overshoot=float(max(0.0, way.beyond) / way.travel * 100.0) if moved else None,
            )


class _Way:
    """One axis on its way to its goal.

    Args:
        band: half width; None: 2 % of the travel.

    Attributes:
        travel: distance at the first tick.
        beyond: largest distance beyond the goal; negative where there is none.
    """

    def __init__(self, band: float | None) -> None:
        self._band, self._sign = band, 0.0
        self._ticks, self._last_outside = 0, -1
        self.travel, self.beyond = 0.0, -np.inf

    def add(self, distances: Vector) -> None:
        """Take the next distances from the goal."""
        if not self._ticks:
            self.travel, self._sign = float(abs(distances[0])), float(np.sign(distances[0]))
        band = SETTLING_BAND * self.travel if self._band is None else self._band
        outside = np.flatnonzero(np.abs(distances) > band)
        if outside.size:
            self._last_outside = self._ticks + int(outside[-1])
        self.beyond = float(np.maximum(self.beyond, (-self._sign * distances).max()))
        self._ticks += distances.size

    def settling_time(self, time: Vector) -> float | None:
        """[s] from the start until the axis stays inside its band; None: it never does."""
        if self._last_outside < 0:
            return 0.0
        inside = self._last_outside + 1
        return float(time[inside] - time[0]) if inside < time.size else None
