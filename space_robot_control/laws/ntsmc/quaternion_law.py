"""Quaternion-based non-singular terminal sliding mode control of a free-flying robot."""

from __future__ import annotations

from space_robot_control.laws.ntsmc.kernel.answer import QUATERNION
from space_robot_control.laws.ntsmc.terminal_sliding import TerminalSliding


class Ntsmc(TerminalSliding):
    """Terminal sliding mode control of base and arm with the attitude error on the unit quaternions.

    With the error quaternion q_e = q_b q_bd^-1 = (eps_e, eta_e) and angular velocities in the inertial frame:

        w_e = w_b - w_d,   e_rot = sgn+(eta_e) eps_e,   sgn+(0) = +1
        eps_e' = 1/2 (eta_e w_e - eps_e x (w_b + w_d))
        s_rot = sign(w_e) |w_e|^r / Gamma_2 + e_rot        (14)

    The rest is ``TerminalSliding`` and ``SlidingMode``; symbols: s, Delta s, xi, K_hat, Gamma, Phi, phi of the paper.
    The equations on one screen: ``reference.py``.

    Deviations from the paper:
        (28c) multiplies K_hat by sat(s/Phi), not by Phi sat(s/Phi): the proof needs K sgn(Delta s), and the printed
        form is 1/Phi times too weak. |xi|^2 in (28c) is floored at Phi: at rest xi/|xi|^2 is 0/0. Powers of rates are
        of absolute values where the proof needs a positive weight, (13), (28b), (29). eps_e' has w_b + w_d where the
        paper prints w_e, which is exact only for w_d = 0. u_1 has C0, the nominal bias. Leak, cap and freeze of K_hat,
        the clamp, the observer and direction-preserving saturation are not in it, off by default; ``per_axis`` is the
        clip of the paper's actuators. Free-floating robots have no sliding variable for translation.

    Reference: [Giordano and Cenedese 2023, secs. IV, V], arXiv 2305.15007.
    """

    name = "ntsmc"

    def attitude(self) -> int:
        """(14)."""
        return int(QUATERNION)
