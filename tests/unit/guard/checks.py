"""What must hold of each command that the guard lets through."""

import pytest

from giraff_guard.obstacles import Limited, Verdicts
from giraff_schemas.messages import GuardedCommand, GuardState


def check_passed(
    passed: GuardedCommand | Limited, verdicts: GuardState | Verdicts, linear: float, angular: float
) -> None:
    """That what passed is never more than was asked or allowed, and that the difference is explained."""
    for got, asked in ((passed.linear_x, linear), (passed.angular_z, angular)):
        assert abs(got) <= abs(asked)
        assert got * asked >= 0.0
    assert abs(passed.linear_x) <= (verdicts.forward if linear > 0.0 else verdicts.backward).allowed + 1e-12
    assert abs(passed.angular_z) <= 1.57
    if passed.linear_x != 0.0:
        assert passed.angular_z / passed.linear_x == pytest.approx(angular / linear)
    elif linear != 0.0:
        assert abs(passed.angular_z) <= 0.35
    if (passed.linear_x, passed.angular_z) != (linear, angular):
        assert passed.reason
