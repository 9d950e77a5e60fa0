"""Gains of a robot that balances, from the masses, inertias and lengths of its robot file.

The state is lean, its rate, place and speed; what acts is the torque of both motors. Neither gear play nor friction is
part of the model: the board compensates them.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from giraff_base.drives.balancer.config import GRAVITY, BalancerConfig
from giraff_schemas.wires.balancer import BALANCE_PERIOD_MS

Matrix = NDArray[np.float64]

PERIOD: Final = BALANCE_PERIOD_MS / 1000
"""s between two commands of the board."""
_COSTS_ONE: Final = (0.03, 0.35, 0.10, 0.30)
"""rad, rad/s, m, m/s that cost one unit."""
_TORQUE_COSTS_ONE: Final = 14.0  # N m
_TERMS: Final = 12  # of the series of an exponential
_DOUBLINGS: Final = 16  # 2^16 periods, 5 minutes: the gains do not change any more


class Gains(NamedTuple):
    """Torque of both motors for each unit of an error, N m."""

    k1: float
    """For each rad of lean."""
    k2: float
    """For each rad/s."""
    k3: float
    """For each m."""
    k4: float
    """For each m/s."""


def gains_of(drive: BalancerConfig, period: float = PERIOD) -> Gains:
    """Return the gains of the linear-quadratic regulator, sampled each `period` s."""
    a, b = sampled(drive, period)
    cost = np.diag(1.0 / np.square(_COSTS_ONE))
    effort = np.array([[1.0 / _TORQUE_COSTS_ONE**2]])
    price = _riccati(a, b, cost, effort)
    gains = -np.linalg.solve(effort + b.T @ price @ b, b.T @ price @ a)
    return Gains(*map(float, gains.ravel()))


def sampled(drive: BalancerConfig, period: float = PERIOD) -> tuple[Matrix, Matrix]:
    """Return what a state and a torque become in one period, of a body near upright."""
    mass, height, radius, rotors = drive.body_mass, drive.centre_height, drive.wheel_radius, 2 * drive.rotor_inertia
    rolling = mass + 2 * drive.wheel_mass + (2 * drive.wheel_inertia + rotors) / radius**2
    coupling = mass * height - rotors / radius
    tipping = drive.body_inertia + mass * height**2 + rotors
    inertia = np.array([[rolling, coupling], [coupling, tipping]])
    by_lean = np.linalg.solve(inertia, np.array([0.0, mass * GRAVITY * height]))
    by_torque = np.linalg.solve(inertia, np.array([1.0 / radius, -1.0]))
    rates = np.zeros((5, 5))  # of lean, its rate, place, speed; the fifth is the torque, which is held
    rates[0, 1] = rates[2, 3] = 1.0
    rates[3, 0], rates[1, 0] = by_lean
    rates[3, 4], rates[1, 4] = by_torque
    whole = term = np.eye(5)
    for power in range(1, _TERMS):
        term = term @ rates * (period / power)
        whole = whole + term
    return whole[:4, :4], whole[:4, 4:]


def _riccati(a: Matrix, b: Matrix, cost: Matrix, effort: Matrix) -> Matrix:
    """Solve the discrete Riccati equation by doubling the horizon (Chu and others, Int J Control 77, 2004)."""
    reach = b @ np.linalg.solve(effort, b.T)
    price = cost
    for _ in range(_DOUBLINGS):
        middle = np.linalg.inv(np.eye(len(a)) + reach @ price)
        a, reach, price = a @ middle @ a, reach + a @ middle @ reach @ a.T, price + a.T @ price @ middle @ a
    return price
