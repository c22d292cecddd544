"""Physically consistent inertial parameters: check, projection, and steps that stay consistent.

A body is physically consistent exactly if its pseudo-inertia P, a symmetric 4 x 4 matrix linear in its ten parameters,
is positive definite (Wensing, Kim, Slotine, IEEE RA-L 3(1), 2018).
"""

from __future__ import annotations

import numpy as np

from space_robot_control.laws.adaptive.kernel.consistency import assess
from space_robot_description.inertia import pseudo_inertia
from space_robot_description.kernel.dense import diagonalise
from space_robot_description.kernel.linear import least_norm
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import exp
from space_robot_msgs_py.kernel.products import times

PER_BODY = 10
MIN_EIGENVALUE = 1e-9  # of a projected pseudo-inertia, relative to its trace
MAX_EXPONENT = 1.0  # of one natural step: a larger one means that the period is too long

_TO_PSEUDO = np.array([pseudo_inertia(unit).ravel() for unit in np.eye(PER_BODY)]).T
_FROM_PSEUDO = least_norm(_TO_PSEUDO.T).T


def pseudo_inertias(parameters: Vector) -> Vector:
    """Return (B, 4, 4) pseudo-inertias of (10 B,) parameters."""
    out: Vector = times(parameters.reshape(-1, PER_BODY), _TO_PSEUDO.T).reshape(-1, 4, 4)
    return out


def is_consistent(parameters: Vector) -> bool:
    """True if every body with these (10 B,) parameters is physically possible."""
    _, _, possible = assess(parameters)
    return possible


def project(parameters: Vector) -> Vector:
    """Return the nearest consistent parameters (10 B,), in the Frobenius norm of the pseudo-inertias.

    Consistent bodies keep their bits.
    """
    if is_consistent(parameters):
        return parameters
    pseudo = pseudo_inertias(parameters)
    values, vectors = _eigen(pseudo)
    floor = MIN_EIGENVALUE * np.maximum(np.abs(values).sum(axis=1, keepdims=True), MIN_EIGENVALUE)
    kept = np.maximum(values, floor)
    nearest = _parameters(np.einsum("bij,bj,bkj->bik", vectors, kept, vectors))
    out = np.where(values.min(axis=1, keepdims=True) >= floor, parameters.reshape(-1, PER_BODY), nearest)
    return out.ravel()


def natural_step(parameters: Vector, gradient: Vector, gain: float) -> Vector:
    """Return parameters (10 B,) after one step along the natural gradient of the log-det divergence.

    P' = gain P L P with tr(L dP) = gradient . dpi, integrated exactly for a gradient that stays:
    P <- R exp(gain R^T L R) R^T with P = R R^T. A consistent estimate stays consistent whatever the gradient; the
    exponent of one step is limited to 1.

    Args:
        parameters: (10 B,) consistent.
        gradient: (10 B,) direction of descent, e.g. Y^T sigma.
        gain: step length.

    Raises:
        numpy.linalg.LinAlgError: the parameters are not consistent.

    Reference: Lee, Kwon, Park, "A natural adaptive control law for robot manipulators", IROS 2018, (17).
    """
    moments, axes = _eigen(pseudo_inertias(parameters))
    if not (moments > 0.0).all():
        raise np.linalg.LinAlgError("a pseudo-inertia is not positive definite")
    root = axes * np.sqrt(moments)[:, None, :]
    dual = times(gradient.reshape(-1, PER_BODY), _FROM_PSEUDO).reshape(-1, 4, 4)
    values, vectors = _eigen(gain * np.einsum("bji,bjk,bkl->bil", root, dual, root))
    turned = np.einsum("bij,bjk->bik", root, vectors)
    grown = np.array([[exp(one) for one in row] for row in np.clip(values, -MAX_EXPONENT, MAX_EXPONENT).tolist()])
    return _parameters(np.einsum("bij,bj,bkj->bik", turned, grown, turned)).ravel()


def _eigen(matrices: Vector) -> tuple[Vector, Vector]:
    """(B, 4) eigenvalues and (B, 4, 4) vectors as columns of symmetric (B, 4, 4)."""
    left, vectors = np.array(matrices, order="C"), np.empty(matrices.shape)
    for one, own in zip(left, vectors, strict=True):
        diagonalise(one, own)
    return np.array(np.diagonal(left, axis1=1, axis2=2)), vectors


def _parameters(pseudo: Vector) -> Vector:
    """(B, 10) of symmetric (B, 4, 4)."""
    out: Vector = times(pseudo.reshape(-1, 16), _FROM_PSEUDO.T)
    return out
