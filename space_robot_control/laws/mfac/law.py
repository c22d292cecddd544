"""Model-free adaptive control as a law: one matrix between increments in place of a model."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np

from space_robot_control.channels import BASE, Channels
from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.compiled import Answering, CompiledLaw, Layout
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.mfac.gains import MfacGains
from space_robot_control.laws.mfac.identification import Identification
from space_robot_control.laws.mfac.incremental_controller import IncrementalController, Weights, weights_of
from space_robot_control.laws.mfac.kernel import answer as kernel
from space_robot_control.laws.mfac.kernel.answer import OWN, TICKS, MfacContext, loop_memory
from space_robot_control.laws.mfac.mapping import Mapping, Scales
from space_robot_control.laws.mfac.pseudo_gradient import PseudoGradient
from space_robot_control.laws.mfac.tuning import Tuning, adjusted, review, tuning
from space_robot_control.nominal_model import NominalModel
from space_robot_control.sensing import Sensing
from space_robot_control.tracking import ERROR_FIELDS, error_blocks
from space_robot_description.kernel.cache import cached
from space_robot_description.kernel.context import context_of
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Command, Reference, RobotState, Vector


class ModelFree(Law):
    """Full-form dynamic-linearisation model-free adaptive control of any channels of a robot.

    The outputs are errors of the chosen channels (``Channels``), attitude as 2 epsilon of the error quaternion; with
    ``form: rate_augmented`` z = e + c e'. The law (16) drives them to zero with Phi from the estimator (17), which
    starts from Phi(1) (19): from the nominal robot, or from inputs and outputs of the first seconds. Symbols: Phi
    ``PseudoGradient``, rho, lambda, kappa ``Weights``, c ``lead``, sigma, beta ``estimator``.

    The equations on one screen: ``reference.py``.

    Args:
        robot: the NOMINAL robot: names, limits, and Phi(1) unless the first seconds give it.
        control_period: [s].
        gains: see ``MfacGains``.

    Raises:
        SpecError: a channel the robot does not have.

    Reference: Song, Zheng, Guo, Yuan, "Application of Model-Free Control to the Operation of Post-Capture Combined
    Spacecraft", Aerospace 10(1):90, 2023, (15)-(22).

    Deviations from the paper: the output z, because y with rho = 1 is unstable when the command is held; lambda
    relative to phi^2; increments of the error in the law, so that a jump of the reference acts at once and a moving one
    leads; anti-windup; filter and gate; the initial value from seconds of samples instead of one.
    """

    class Gains(MfacGains):
        """Gains of the model-free law."""

    name = "mfac"
    gain_ranges: ClassVar[GainRanges] = {"lead": GainRange(0.5, 20.0), "kappa": GainRange(0.05, 10.0)}
    uses_command_delay = True
    telemetry_fields = ERROR_FIELDS | {
        "output": "z or e of the channels [m, rad]",
        "pseudo_gradient": "phi of the input, row by row [m/N, rad/(N m)]",
        "innovation": "dy - Phi dH of the estimator [units of the law]",
        "resets": "resets of Phi so far [-]",
        "gate_count": "samples refused by the gate so far [-]",
        "saturated": "1: the channel is at its limit [-]",
        "saturation_share": "share of the periods with a channel at its limit [-]",
        "identifying": "1: a push or pulses determine Phi(1) [-]",
        "initial_gain": "diagonal of B behind Phi(1) [1/kg, 1/(kg m2)]",
        "initial_deviation": "relative deviation of initial_gain; 0: the nominal one [-]",
    }
    gains: Gains

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.channels = Channels(robot, self.gains.outputs, self.gains.held)
        self._model, self._limit = NominalModel(robot), self.channels.limits()
        self._sensing = Sensing(self.channels, self.gains.filter, control_period)
        self._tuning = tuning(self.gains, self.channels, control_period)
        delay = robot.command_delay
        self._identification = Identification(self.gains, self.channels, self._limit, control_period, delay)
        self._make_kernels()
        self.reset()

    @classmethod
    def must_compile(cls) -> bool:
        """True before the first model-free law on a machine."""
        return not cached(Path(kernel.__file__), kernel.answer.__name__)

    def _make_kernels(self) -> None:
        """Estimator and controller in the units of the law, of a Phi(1) that ``_begin`` replaces."""
        spec, orders, m = self.gains.estimator, (self.gains.output_order, self.gains.input_order), self.channels.size
        first = Mapping(self.control_period, None, *orders).first(np.eye(m))
        self._gradient = PseudoGradient(first, *orders, sigma=spec.sigma, beta=spec.beta, floor=spec.floor)
        self._controller = IncrementalController(_weights(self.gains, self._tuning), *orders, self._limit)
        self._loop, self.layout = loop_memory(m, self.robot.command_delay), _layout(self.n, m)
        sensing, gradient, controller = self._sensing, self._gradient, self._controller
        known = sensing.rule, sensing.memory, gradient.rule, gradient.memory, controller.rule, controller.memory
        self._context = context_of(MfacContext(*known, self._loop), kernel.keep)
        self._answer = Answering(kernel.answer, self.n, self.layout)

    def retune(self, gains: Gains) -> None:
        """Go on with another kappa or rho; Phi and the past stay."""
        if gains.adjust:
            raise SpecError(
                "chosen during the run", key="controller.gains.adjust", value=True, accepted="false, to tune"
            )
        self._tuning = tuning(gains, self.channels, self.control_period)
        self._controller.set_weights(_weights(gains, self._tuning))

    def review(self, path: Sequence[Reference]) -> Review:
        """Find where the sampled loop of each channel stands on the stability map; warn where it is unstable."""
        response = self.channels.response(self._model, path[0].q)
        return review(self.gains, self.channels, self._tuning, response, self.control_period)

    def reset(self) -> None:
        """Forget the past, Phi included."""
        super().reset()
        self._sensing.reset()
        self._identification.reset()
        for array in self._loop:
            array[:] = 0
        self._loop.counts[OWN] = 1
        # The one behind Phi(1); before there is one, that of the nominal robot at the first state.
        self._response: Vector | None = None
        self._begun = False

    def prepare(self) -> None:
        """Compile the answer."""
        self._answer.prepare()

    def compiled(self) -> CompiledLaw | None:
        """The law with Phi(1) from the nominal robot, which is known at the first state."""
        if self._identification.ticks or self.gains.adjust:
            return None
        return CompiledLaw(kernel.answer, self._context, self.layout, kernel.note, self._begin)

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class.

        Raises:
            ControlError: lambda + phi^T phi has no inverse, or the result is not finite.
            SpecError: phi(1) has no inverse.
        """
        if not self._begun:
            if self._loop.counts[TICKS] == 0:
                self._start = self._first_error(state, reference)
            if self._loop.counts[TICKS] < self._identification.ticks:
                return self._identify(state, reference)
            self._begin(state)
        status, u, row = self._answer(self._context, state, reference, self.wheels.momentum)
        self._controller.check(status)
        return u, self.layout.blocks(row)

    def on_applied(self, command: Command, *, own: bool) -> None:
        """The estimator leaves out periods under another law's command."""
        if self._begun:
            self._loop.counts[OWN] = own

    def _first_error(self, state: RobotState, reference: Reference) -> Vector:
        """Errors (m,) of the channels, from which a push knows its direction and ``adjust`` the size of a step."""
        first = Sensing(self.channels, None, self.control_period)
        first.update(state, reference)
        return first.memory.error

    def _nominal(self, state: RobotState) -> Vector:
        if self._response is None:
            self._response = self.channels.response(self._model, state.q)
        return self._response

    def _begin(self, state: RobotState) -> None:
        """Set Phi(1), and what depends on it."""
        gains, chosen, loop = self.gains, self._tuning, self._loop
        found, loop.deviation[:] = self._identification.response(self._nominal(state))
        response = gains.initial.scale * found
        if gains.adjust:
            chosen = adjusted(np.diag(response), self._limit, self._start, self.control_period)
        lead = chosen.lead if gains.form == "rate_augmented" else None
        mapping = Mapping(self.control_period, lead, gains.output_order, gains.input_order)
        scales = self._scales(mapping.gain(response))
        self._gradient.begin(scales.scaled(mapping.first(response), gains.output_order))
        self._controller.begin(_weights(gains, chosen), self._limit / scales.input)
        loop.lead[:] = 0.0 if lead is None else lead
        loop.output[:], loop.input[:], loop.response[:] = scales.output, scales.input, np.diag(response)
        loop.out[:] = 0.0
        self._begun = True

    def _scales(self, gain: Vector) -> Scales:
        if self.gains.units == "printed":
            lengths = np.array([name in BASE[:3] for name in self.channels.names])
            return Scales.printed(lengths, self.channels.size)
        return Scales.full_scale(gain, self._limit)

    def _identify(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """An answer of the first seconds, before there is a Phi."""
        errors, sensed, loop = self._sensing.update(state, reference), self._sensing.memory, self._loop
        inputs = self._identification.inputs(int(loop.counts[TICKS]), self._start, sensed.moved_sample)
        loop.counts[TICKS] += 1
        lead = self._tuning.lead if self.gains.form == "rate_augmented" else 0.0
        blocks = self.layout.blocks(np.zeros(self.layout.size)) | error_blocks(errors)
        blocks["output"] = sensed.error + lead * sensed.rate
        blocks["gate_count"] = np.array([self._sensing.refused.sum()])
        blocks["identifying"] = np.ones(1)
        blocks["initial_gain"] = np.diag(self._nominal(state))
        return self.channels.spread(inputs), blocks


def _layout(n: int, m: int) -> Layout:
    errors = {"position_error": 3, "attitude_error": 3, "joint_error": n, "twist_error": 6, "joint_rate_error": n}
    estimate = {"output": m, "pseudo_gradient": m * m, "innovation": m, "resets": 1, "gate_count": 1}
    state = {"saturated": m, "saturation_share": 1, "identifying": 1, "initial_gain": m, "initial_deviation": m}
    return Layout.of({**errors, **estimate, **state})


def _weights(gains: MfacGains, chosen: Tuning) -> Weights:
    return weights_of(gains.output_order, gains.input_order, chosen.rho, chosen.kappa, gains.control_weight)
