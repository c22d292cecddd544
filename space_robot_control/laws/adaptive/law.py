"""Adaptive control by linear separation of the inertial parameters, after Liu, Teng, Jin (2023)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import cos, degrees, radians
from pathlib import Path
from typing import ClassVar

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.adaptive.compiled import compiled_adaptive
from space_robot_control.laws.adaptive.cycle import Cycle
from space_robot_control.laws.adaptive.euler_coordinates import PITCH, euler_state
from space_robot_control.laws.adaptive.gains import AdaptiveGains
from space_robot_control.laws.adaptive.kernel import control
from space_robot_control.laws.adaptive.kernel.workspace import PeriodStart
from space_robot_control.laws.adaptive.parameter_update import ParameterUpdate
from space_robot_control.laws.adaptive.regressor import Regressor
from space_robot_control.laws.adaptive.review import AdaptiveReview
from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.compiled import CompiledLaw
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_description.kernel.cache import cached
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import ControlError, SpecError
from space_robot_msgs_py.interfaces import Command, Reference, RobotState, Vector


class Adaptive(Law):
    """u = Y(Theta, Theta', Theta_r', Theta_r'') pi_hat + K_D sigma, with pi_hat corrected during the run.

    In Euler coordinates Theta, desired minus actual e = Theta_d - Theta:

        Theta_r' = Theta_d' + Lambda e,   Theta_r'' = Theta_d'' + Lambda e',   sigma = e' + Lambda e      (32), (33)

    With exact parameters and a short period e' = -Lambda e + sigma and M sigma' + C sigma + K_D sigma = 0. The other
    reading, ``lambda_on: velocity``, is Theta_r' = Theta_d', Theta_r'' = Theta_d'', sigma = Lambda e' + e: a PD law
    whose damping Lambda weighs, and the one under which the paper's Fig. 10 appears.

    Free-floating robots: the three rows of zero force give the translation, p_r'' = -(Y_p pi_hat) / m_hat, and the
    eliminated part of sigma, sigma_p = -(M_pr sigma) / m_hat; no accelerometer and no algebraic loop is needed.
    Free-flying robots: translation is controlled like the rest.

    Updates (``update``): ``none``; ``rls`` (39)-(41); ``rls_filtered``, the same on both sides of the regression behind
    a filter; ``lyapunov`` pi_hat' = Gamma Y^T [sigma_p, sigma] (44);
    ``composite``: RLS and (44) with Gamma = gamma G, G the covariance.

    The equations on one screen: ``reference.py`` and ``reference_dynamics.py``.

    Deviations from the paper: the base translation is not eliminated from the parametrisation (the virtual manipulator
    of sec. 2 makes the dynamics nonlinear in pi) but from the command; both Y of (38) and (44) are Slotine-Li's with
    four arguments; K_D = kappa M(pi_0, Theta_0) is the full matrix, M reduced by the free translation; (40) is weighted
    by the torque noise, in square-root form and with a reset; (44) has the term of translation; ``lead`` and
    ``consistency`` are not in it. docs/papers/liu2023.md lists the errata.

    Args:
        robot: the NOMINAL robot.
        control_period: [s].
        gains: see ``AdaptiveGains``.

    Raises:
        SpecError: the gains do not fit the robot.

    Reference: Liu, Teng, Jin, Aerospace 10, 679, 2023; Slotine and Li, IJRR 6(3), 1987.
    """

    class Gains(AdaptiveGains, Law.Gains):
        """Gains of the adaptive law."""

    name = "adaptive"
    gain_ranges: ClassVar[GainRanges] = {"lambda": GainRange(0.05, 2.0), "kappa": GainRange(0.02, 2.0)}
    uses_command_delay = True
    telemetry_fields: ClassVar[Mapping[str, str]] = {
        "position_error": "p_d - p, inertial axes; free-flying robots [m]",
        "euler_error": "errors of roll, pitch, yaw [rad]",
        "joint_error": "q_d - q [rad or m]",
        "sliding_variable": "sigma: translation if free-flying, roll, pitch, yaw, joints [m/s, rad/s]",
        "lyapunov_function": "sigma^T M_hat sigma / 2 + e^T Lambda K_D e [J]",
        "parameters": "pi_hat: m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the joint origin, per body [kg, kg m, kg m2]",
        "consistent": "1: every body is physically possible [-]",
        "innovation": "with RLS: tau - Y pi_hat of the last period [N, N m]",
        "surprise": "with RLS: squared innovation over its variance, mean of the rows [-]",
        "covariance_trace": "with RLS: trace of G [mixed]",
        "resets": "with RLS: resets of the covariance so far [-]",
        "learned": "with RLS: 0: the base command was beyond the actuators and the period is left out [-]",
    }
    gains: Gains

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.regressor = Regressor(robot)
        self._cycle = Cycle(robot, self.gains, control_period)
        self._first = self._cycle.rule.first
        self._check_damping(len(self._cycle.rule.k_d))
        self._pitch_limit = radians(self.gains.pitch_limit_deg)
        self.reset()

    @classmethod
    def must_compile(cls) -> bool:
        """True before the first adaptive law on a machine."""
        return not cached(Path(control.__file__), control.control.__name__)

    def reset(self) -> None:
        """Forget the past: estimate, covariance and damping matrix are those of the start again."""
        super().reset()
        self._cycle.reset()
        self._update = ParameterUpdate(self.robot, self.regressor.parameters, self._cycle, self.gains)
        self._mass: Vector | None = None
        self._start: tuple[Vector, Vector, Vector] | None = None

    def resume(self) -> None:
        """Keep what was learned of the robot; only the last period is forgotten."""
        super().reset()
        self._cycle.reset()
        self._update.pause()
        self._start = None

    def health(self) -> Mapping[str, float]:
        """Condition and trace of the RLS covariance, resets, and whether every body can exist."""
        return self._update.health()

    def retune(self, gains: Gains) -> None:
        """Go on with another Lambda or kappa; K_D stays kappa times the matrix of the first state."""
        self._cycle.rule.lambda_[:] = gains.lambda_.values(self.robot, "controller.gains.lambda")[self._first :]
        if self._mass is not None:
            self._cycle.rule.k_d[:] = gains.kappa * self._mass

    def review(self, path: Sequence[Reference]) -> Review:
        """The sampled-data stability rule along the path, see ``stability.stable_lambda``."""
        return AdaptiveReview(self.robot, self.regressor, self.gains, self.control_period).along(path)

    def compiled(self) -> CompiledLaw | None:
        """The law without projection of its estimate, which is Python, and for a joint per body."""
        if self.gains.consistency != "none" or self.robot.mimics:
            return None
        limits, update = CommandLimits(self.robot), self._update
        found = compiled_adaptive(
            self._cycle, self.gains, limits, self.regressor.parameters, consistent=bool(update.consistent)
        )
        return replace(found, start=self._begin)

    def _begin(self, state: RobotState) -> None:
        """K_D is that of the first state."""
        if self._mass is None:
            self._mass = self._first_mass_matrix(euler_state(state)[0])
            self._cycle.rule.k_d[:] = self.gains.kappa * self._mass

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class.

        Raises:
            ControlError: the attitude is near the singularity of Euler angles, K_D is not positive definite, or the
                estimate is unusable.
        """
        x, dx = euler_state(state)
        self._check_pitch(x)
        self._update.observe(state, x, dx, self._measured_wheels())
        self._begin(state)
        omega = state.v[3:6]
        u, value = self._cycle.control(
            self._update.estimate, x, dx, omega, self._known(self.wheels.momentum), reference
        )
        work = self._cycle.workspace
        blocks = {**self._error_blocks(), "lyapunov_function": value, **self._update.blocks()}
        self._update.track(work.Y, work.sigma_full)
        self._start = x, dx, omega
        return u, blocks

    def on_applied(self, command: Command, *, own: bool) -> None:
        """The update needs the command of periods that began with ``compute``."""
        wrench = np.array(command.wrench)
        if self._start is not None:
            self._update.begin(PeriodStart(*self._start, self._known(self.wheels.middle), wrench))
        self._start = None

    def _measured_wheels(self) -> tuple[Vector, Vector] | None:
        measured = self.wheels.measured
        if measured is None or self.gains.rls.wheel_torque == "commanded":
            return None
        return self._known(measured[0]), measured[1]

    def _known(self, momentum: Vector) -> Vector:
        return momentum if self.gains.gyroscopic else np.zeros(3)

    def _first_mass_matrix(self, x: Vector) -> Vector:
        if self.gains.damping_inertia is not None:
            return np.array(self.gains.damping_inertia)
        matrix = self._cycle.mass_matrix(x, self.regressor.parameters)
        lowest = float(np.linalg.eigvalsh(matrix)[0])
        if not lowest > 0.0:
            raise ControlError(
                "the mass matrix of the nominal model is not positive definite",
                key="K_D",
                value=lowest,
                accepted="eigenvalues > 0: a prior nearer to a robot that can exist",
            )
        return matrix

    def _check_damping(self, size: int) -> None:
        given = self.gains.damping_inertia
        if given is not None and len(given) != size:
            key = "controller.gains.damping_inertia"
            raise SpecError("not of the size of this robot", key=key, value=len(given), accepted=f"{size} rows")

    def _check_pitch(self, x: Vector) -> None:
        pitch = float(x[PITCH])
        if abs(pitch) > self._pitch_limit:
            limit = self.gains.pitch_limit_deg
            raise ControlError(
                "the base is near the singularity of Euler angles",
                key="pitch",
                value=f"{degrees(pitch):.6g} deg (cos {cos(pitch):.3g})",
                accepted=f"-{limit:g} to {limit:g} deg; ntsmc and computed_torque have no such limit",
            )

    def _error_blocks(self) -> dict[str, Vector]:
        work, order, rotation = self._cycle.workspace, self._cycle.order, 3 - self._first
        e = work.e[order]
        blocks = {
            "euler_error": e[rotation : rotation + 3],
            "joint_error": e[rotation + 3 :],
            "sliding_variable": work.sigma[order],
        }
        return blocks if self._first else {"position_error": e[:3], **blocks}
