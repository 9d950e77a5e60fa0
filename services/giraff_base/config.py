"""Table `[base]` of the robot file."""

from __future__ import annotations

import math

import msgspec


class BaseConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    port: str
    """Serial port of the base board."""
    operator_budget: float = 0.4
    """s; largest age of the operator's tick."""
    guard_budget: float = 0.2
    """s; largest age of the guard's tick."""
    range_budget: float = 0.4
    """s; largest age of the oldest range that the motion relies on."""
    arm_time: float = 0.2
    """s that a neutral hand must be held to arm the robot."""
    disarm_time: float = 1.0
    """s of stale command or range after which the robot must be armed again."""
    guard_silence: float = 0.5
    """s of silence after which another guard may take the place of the one in charge."""
    linear_acceleration: float = 0.6
    """m/s², of starts only: a stop is immediate."""
    angular_acceleration: float = 2.5
    """rad/s², of starts only."""

    def __post_init__(self) -> None:
        for field in self.__struct_fields__:
            value = getattr(self, field)
            if field != "port" and not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{field} is {value}: it must be a positive number")
