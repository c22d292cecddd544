"""Choice of lead, kappa and rho, and their review on the stability map."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from space_robot_control.channels import BASE, Channels
from space_robot_control.laws.base import Review
from space_robot_control.laws.mfac.gains import MfacGains
from space_robot_control.laws.mfac.mapping import Mapping, Scales
from space_robot_control.laws.mfac.stability import spectral_radius
from space_robot_description.spec import expand
from space_robot_msgs_py.interfaces import Vector

DEFAULT_LEAD_PERIODS = 10.0
# [control periods]: time scale of a channel that starts at its target and has no step to size its loop by.
MIN_TAU = 60.0


@dataclass(frozen=True, eq=False, slots=True)
class Tuning:
    """Per channel: lead c [s], kappa = lambda / phi^2 [-] and rho of the error [-], (m,) each."""

    lead: Vector
    kappa: Vector
    rho: Vector


def tuning(gains: MfacGains, channels: Channels, period: float) -> Tuning:
    """Return the gains with defaults filled in.

    The loop of z alone obeys z'' + (g/T) (z' + rho z / T) = 0 with g = 1/(1 + kappa): rho = g/4 damps it critically.
    """
    lead = np.full(channels.size, DEFAULT_LEAD_PERIODS * period)
    if gains.lead is not None:
        lead = np.array(expand(gains.lead, channels.names, "controller.gains.lead"))
    kappa = np.full(channels.size, gains.kappa)
    if gains.rho is not None:
        return Tuning(lead, kappa, np.full(channels.size, gains.rho))
    return Tuning(lead, kappa, period / lead if gains.form == "position" else 0.25 / (1.0 + kappa))


def adjusted(gain: Vector, limit: Vector, error: Vector, period: float) -> Tuning:
    """Return a tuning for a step of this size with this authority: the paper's announced next step, as read here.

    tau = sqrt(|e| / (b u_max)) is the time scale of the fastest step; c = 0.65 tau leaves the limit in time, and the
    loop of z crosses over at 3 / tau, that is kappa = tau / (3 T) - 1, not below 1.

    Args:
        gain: (m,) b of each channel.
        limit: (m,) u_max.
        error: (m,) at the beginning.
        period: T [s].
    """
    tau = np.maximum(np.sqrt(np.abs(error) / (np.abs(gain) * limit)), MIN_TAU * period)
    kappa = np.maximum(tau / (3.0 * period) - 1.0, 1.0)
    return Tuning(0.65 * tau, kappa, 0.25 / (1.0 + kappa))


def review(gains: MfacGains, channels: Channels, chosen: Tuning, response: Vector, period: float) -> Review:
    """Return where each channel by itself stands on the stability map, with Phi frozen at the nominal Phi(1)."""
    facts, warnings = [], []
    lead = chosen.lead if gains.form == "rate_augmented" else None
    gain = np.diag(Mapping(period, lead, gains.output_order, 1).gain(response))
    lengths = np.array([name in BASE[:3] for name in channels.names])
    scales = Scales.printed(lengths, channels.size)
    phi = gain * scales.output if gains.units == "printed" else np.ones(channels.size)
    for i, name in enumerate(channels.names):
        share = float(chosen.kappa[i]) + gains.control_weight / float(phi[i] * phi[i])
        ratio, periods = 1.0 / max(share, 1e-9), None if lead is None else float(lead[i]) / period
        radius, late = (spectral_radius(ratio, float(chosen.rho[i]), delay, lead=periods) for delay in (0, 1))
        place = f"phi^2/lambda = {ratio:.3g}, rho = {chosen.rho[i]:.3g}"
        facts.append(f"mfac {name}: {place}: spectral radius {radius:.4f}, one period late {late:.4f}")
        if radius >= 1.0:
            warnings.append(f"mfac {name}: unstable when the command is held ({place}: spectral radius {radius:.3f})")
    return Review(tuple(facts), tuple(warnings))
