"""Gains of a robot that balances, from the masses, inertias and lengths of its robot file."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from giraff_base.drives.balancer.config import BalancingBody
from giraff_base.drives.balancer.setup import PERIOD, Gains

Matrix = NDArray[np.float64]

_COSTS_ONE: Final = (0.03, 0.35, 0.10, 0.30)
"""rad, rad/s, m, m/s that cost one unit."""
_TORQUE_COSTS_ONE: Final = 14.0  # N m
_DOUBLINGS: Final = 16  # 2^16 periods, 5 minutes: the gains do not change any more


def gains_of(body: BalancingBody, period: float = PERIOD) -> Gains:
    """Return the gains of the linear-quadratic regulator, sampled each `period` s."""
    a, b = sampled(body, period)
    cost = np.diag(1.0 / np.square(_COSTS_ONE))
    effort = np.array([[1.0 / _TORQUE_COSTS_ONE**2]])
    price = _riccati(a, b, cost, effort)
    gains = -np.linalg.solve(effort + b.T @ price @ b, b.T @ price @ a)
    return Gains(*map(float, gains.ravel()))


def sampled(body: BalancingBody, period: float = PERIOD) -> tuple[Matrix, Matrix]:
    """Return what a state and a torque become in one period, of a body near upright."""
    a, b = body.mechanics.sampled(period)
    return np.array(a), np.array(b)[:, np.newaxis]


def _riccati(a: Matrix, b: Matrix, cost: Matrix, effort: Matrix) -> Matrix:
    """Solve the discrete Riccati equation by doubling the horizon (Chu and others, Int J Control 77, 2004)."""
    reach = b @ np.linalg.solve(effort, b.T)
    price = cost
    for _ in range(_DOUBLINGS):
        middle = np.linalg.inv(np.eye(len(a)) + reach @ price)
        a, reach, price = a @ middle @ a, reach + a @ middle @ reach @ a.T, price + a.T @ price @ middle @ a
    return price
