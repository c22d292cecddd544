"""Model-free adaptive control as a law: one matrix between increments in place of a model."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from space_robot_control.channels import BASE, Channels
from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.mfac.gains import MfacGains
from space_robot_control.laws.mfac.incremental_controller import IncrementalController, Weights, weights_of
from space_robot_control.laws.mfac.initial_value import Pulses, Push, Response, ResponseFit
from space_robot_control.laws.mfac.mapping import Mapping, Scales
from space_robot_control.laws.mfac.pseudo_gradient import PseudoGradient
from space_robot_control.laws.mfac.tuning import Tuning, adjusted, review, tuning
from space_robot_control.nominal_model import NominalModel
from space_robot_control.sensing import Sensing
from space_robot_control.tracking import ERROR_FIELDS, error_blocks, tracking_errors
from space_robot_description.robot import Robot
from space_robot_description.spec import expand
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
        initial, m = self.gains.initial, self.channels.size
        self._fit = ResponseFit(control_period, m, diagonal=initial.source == "push")
        ticks = max(1, round(initial.seconds / control_period))
        size = self._limit * expand(initial.level, self.channels.names, "controller.gains.initial.level")
        self._excitation: Push | Pulses | None = None
        if initial.source != "nominal":
            pulses = initial.source == "pulses"
            self._excitation = Pulses(max(1, ticks // 4), size) if pulses else Push(ticks, size)
        self.reset()

    def retune(self, gains: Gains) -> None:
        """Go on with another kappa or rho; Phi and the past stay."""
        if gains.adjust:
            raise SpecError(
                "chosen during the run", key="controller.gains.adjust", value=True, accepted="false, to tune"
            )
        self._tuning = tuning(gains, self.channels, self.control_period)
        if self._loop is not None:
            self._loop.controller.set_weights(_weights(gains, self._tuning))

    def review(self, path: Sequence[Reference]) -> Review:
        """Find where the sampled loop of each channel stands on the stability map; warn where it is unstable."""
        response = self.channels.response(self._model, path[0].q)
        return review(self.gains, self.channels, self._tuning, response, self.control_period)

    def reset(self) -> None:
        """Forget the past, Phi included."""
        super().reset()
        self._sensing.reset()
        self._fit.reset()
        zero = np.zeros(self.channels.size)
        self._start, self._moved, self._out, self._deviation = zero, zero, zero, zero
        self._loop: _Loop | None = None
        # Inputs that do not act yet, the oldest first.
        self._waiting = deque([zero] * self.robot.command_delay)
        self._tick = self._saturated = 0

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class."""
        errors = tracking_errors(state, reference)
        self._sensing.update(state, reference, self.channels.errors(state, errors))
        if self._tick == 0:
            self._start, self._response = self._sensing.error, self.channels.response(self._model, state.q)
        excitation = self._excitation
        identifying = excitation is not None and self._tick < excitation.ticks
        inputs = self._control() if excitation is None or not identifying else self._identify(excitation)
        self._tick += 1
        return self.channels.spread(inputs), {**error_blocks(errors), **self._blocks(identifying)}

    def on_applied(self, command: Command, *, own: bool) -> None:
        """The estimator leaves out periods under another law's command."""
        if self._loop is not None:
            self._loop.own = own

    def _identify(self, excitation: Push | Pulses) -> Vector:
        self._moved = self._moved + self._sensing.moved_sample
        inputs = excitation.at(self._tick, self._start)
        self._waiting.append(inputs)
        self._fit.add(self._moved, self._waiting.popleft())
        self._out = self._lead_output(self._tuning.lead)
        return inputs

    def _control(self) -> Vector:
        if self._loop is None:
            self._loop = self._begin()
        inputs = self._loop.update(self._sensing)
        self._saturated += int(self._loop.controller.saturated.any())
        self._out = self._loop.out
        return inputs

    def _begin(self) -> _Loop:
        """Set Phi(1), and what depends on it."""
        chosen = self._tuning
        if self._excitation is not None:
            self._response, self._deviation = _trusted(self._fit.solve(), self._response, self.gains.initial.trust)
        self._response = self.gains.initial.scale * self._response
        if self.gains.adjust:
            chosen = adjusted(np.diag(self._response), self._limit, self._start, self.control_period)
        delay = self.robot.command_delay
        return _Loop(self.gains, self.channels, chosen, self._response, self._limit, self.control_period, delay)

    def _lead_output(self, lead: Vector) -> Vector:
        return self._sensing.error + (lead * self._sensing.rate if self.gains.form == "rate_augmented" else 0.0)

    def _blocks(self, identifying: bool) -> Blocks:
        m, loop = self.channels.size, self._loop
        nothing = np.zeros(m)
        return {
            "output": self._out,
            "pseudo_gradient": np.zeros(m * m) if loop is None else loop.gain().ravel(),
            "innovation": nothing if loop is None else loop.gradient.innovation,
            "resets": 0.0 if loop is None else float(loop.gradient.resets),
            "gate_count": self._sensing.refused.sum(),
            "saturated": nothing if loop is None else loop.controller.saturated.astype(np.float64),
            "saturation_share": self._saturated / self._tick,
            "identifying": float(identifying),
            "initial_gain": np.diag(self._response),
            "initial_deviation": self._deviation,
        }


class _Loop:
    """Estimator and controller in the units of the law, once Phi(1) is known."""

    def __init__(
        self,
        gains: MfacGains,
        channels: Channels,
        chosen: Tuning,
        response: Vector,
        limit: Vector,
        period: float,
        delay: int,
    ) -> None:
        lead = chosen.lead if gains.form == "rate_augmented" else None
        mapping = Mapping(period, lead, gains.output_order, gains.input_order)
        lengths = np.array([name in BASE[:3] for name in channels.names])
        self._scales = (
            Scales.printed(lengths, channels.size)
            if gains.units == "printed"
            else Scales.full_scale(mapping.gain(response), limit)
        )
        first, spec = self._scales.scaled(mapping.first(response), gains.output_order), gains.estimator
        orders = gains.output_order, gains.input_order
        self.gradient = PseudoGradient(first, *orders, sigma=spec.sigma, beta=spec.beta, floor=spec.floor)
        self.controller = IncrementalController(_weights(gains, chosen), *orders, limit / self._scales.input)
        self._lead, self._order = lead, gains.output_order
        self.out, self._begun, self.own = np.zeros(channels.size), False, True
        # Increments of the input that do not act yet, the oldest first.
        self._waiting = deque([np.zeros(channels.size)] * delay)

    def update(self, sensing: Sensing) -> Vector:
        """(m,) inputs, SI."""
        lead = np.zeros(self.out.size) if self._lead is None else self._lead
        out = sensing.error + lead * sensing.rate
        if self._begun:
            self._waiting.append(self.controller.increment)
            acted = self._waiting.popleft()
            own = self._scales.output * (sensing.moved + lead * sensing.sped)
            if sensing.missing.any() or not self.own:
                self.gradient.skip(acted)
            else:
                self.gradient.update(own, acted)
        # The first increment counts from zero error: a run starts as if its reference had just jumped.
        change, self.out = out - self.out, out
        error, dy = self._scales.output * out, -self._scales.output * change
        if self._begun and self._waiting:
            error, dy = self._predicted(error, dy, own)
        self._begun = True
        return self._scales.input * self.controller.update(error, dy, self.gradient)

    def _predicted(self, error: Vector, dy: Vector, own: Vector) -> tuple[Vector, Vector]:
        """Error and change when the next command acts; Phi says what the present one does, the reference goes on."""
        moved = self.gradient.predict(self.controller.increment)
        change = moved + dy - own
        return error - change, change

    def gain(self) -> Vector:
        """Phi of the input, (m, m), SI."""
        phi = self.gradient.block(self._order)
        out: Vector = phi / self._scales.output[:, None] / self._scales.input
        return out


def _weights(gains: MfacGains, chosen: Tuning) -> Weights:
    return weights_of(gains.output_order, gains.input_order, chosen.rho, chosen.kappa, gains.control_weight)


def _trusted(found: Response, nominal: Vector, trust: float) -> tuple[Vector, Vector]:
    """The fitted response where every diagonal entry is well enough known and positive, else the nominal one."""
    relative = found.relative
    if (relative <= trust).all() and (np.diag(found.gain) > 0.0).all():
        return found.gain, relative
    return nominal, np.minimum(relative, 1e6)
