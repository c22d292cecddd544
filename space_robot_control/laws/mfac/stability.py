"""Where the model-free loop is stable when its command is held: the map behind the choice of rho and lambda."""

from __future__ import annotations

from typing import Literal

import numpy as np

from space_robot_msgs_py.interfaces import Vector

Plant = Literal["held", "euler"]


def loop_matrix(ratio: float, rho: float, delay: int = 0, plant: Plant = "held", lead: float | None = None) -> Vector:
    """Return the closed loop of the one-channel law on a double integrator, over one period.

    The plant y'' = b u with u held over a period T is scaled to T = 1 and b T^2 = 1, so its state is [y, T y']. The law
    (16) has Ly = 2, Lu = 1, rho_1 = rho_2 = 1 and the exact derivatives: of the position, phi = b T^2, phi_1 = 2 and
    phi_2 = -1; of z = y + lead T y', phi = lead + 1/2, phi_1 = 1 and phi_2 = 0. Its gain times phi is
    ratio / (1 + ratio) with ratio = phi^2 / lambda = 1 / kappa.

    Args:
        ratio: phi^2 / lambda [-], positive.
        rho: rho_3, weight of the error [-].
        delay: periods until a command acts, 0 or 1.
        plant: ``held``: exact for a held command; ``euler``: the difference equation of the paper.
        lead: None: the output is y; else the periods of rate in z.

    Returns:
        (5 + delay, 5 + delay) matrix on [y(k), T y'(k), out(k-1), out(k-2), u(k-1), u(k-2)].

    Reference: Song et al. (2023), (13), (16).
    """
    n = 5 + delay
    phi, phi_1, phi_2 = (1.0, 2.0, -1.0) if lead is None else (lead + 0.5, 1.0, 0.0)
    gain = ratio / (1.0 + ratio) / phi
    out = np.zeros(n)
    out[:2] = 1.0, lead or 0.0
    law = -gain * (rho + phi_1) * out
    law[2] += gain * (phi_1 - phi_2)
    law[3] += gain * phi_2
    law[4] += 1.0
    acting = law if delay == 0 else np.eye(n)[4]
    step = np.zeros((n, n))
    step[0, :2], step[1, 1] = 1.0, 1.0
    step[0] += acting * (1.0 if plant == "euler" else 0.5)
    step[1] += acting
    step[2], step[3, 2], step[4] = out, 1.0, law
    if delay:
        step[5, 4] = 1.0
    return step


def spectral_radius(
    ratio: float, rho: float, delay: int = 0, plant: Plant = "held", lead: float | None = None
) -> float:
    """Return the largest |eigenvalue| of ``loop_matrix``: the loop is stable if and only if it is below 1.

    Arguments as there. The law in its incremental form has no eigenvalue of its own on the circle, so 1 is the border.
    """
    return float(np.abs(np.linalg.eigvals(loop_matrix(ratio, rho, delay, plant, lead))).max())


def stability_map(
    ratios: Vector, rhos: Vector, delay: int = 0, plant: Plant = "held", lead: float | None = None
) -> Vector:
    """Return the spectral radius over a grid: the data of a figure.

    Args:
        ratios: (a,) phi^2 / lambda [-].
        rhos: (b,) rho_3 [-].
        delay: periods until a command acts, 0 or 1.
        plant: see ``loop_matrix``.
        lead: see ``loop_matrix``.

    Returns:
        (a, b) spectral radii [-].
    """
    return np.array([[spectral_radius(float(r), float(w), delay, plant, lead) for w in rhos] for r in ratios])
