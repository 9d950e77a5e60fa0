"""The wheels of a robot on the network, and what that robot goes by."""

from __future__ import annotations

import math
import time
from typing import Any, Final

from giraff_core.robot import RobotConfig
from giraff_schemas.messages import Sample, Wheels
from giraff_schemas.topics import WHEELS, Topic
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.limits import ask_base

_PATIENCE: Final = 3.0  # s
_TURN: Final = 0.02  # s
_COMPARED: Final = ("track_width", "ticks_per_metre")
"""What scales are factors of."""


class NetworkWheels:
    """Hears them."""

    def __init__(self, connection: RobotConnection) -> None:
        self._connection = connection
        self._waiting: list[Wheels] = []
        self._heard_at = -math.inf
        connection.subscribe(WHEELS)

    def wait(self, patience: float) -> bool:
        """Whether any come within so many s. They stay to be polled."""
        deadline = time.monotonic() + patience
        while not self._waiting and time.monotonic() < deadline:
            self._connection.dispatch(self)
            time.sleep(_TURN)
        return bool(self._waiting)

    def poll(self) -> list[Wheels]:
        """What came since the last call."""
        self._connection.dispatch(self)
        heard, self._waiting = self._waiting, []
        return heard

    @property
    def silence(self) -> float:
        """s since the last one came; infinite where none has."""
        return time.monotonic() - self._heard_at

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """As a `Listener`."""
        del topic, key, at_ns
        if isinstance(sample, Wheels):
            self._waiting.append(sample)
            self._heard_at = time.monotonic()

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """Wheels that are silent say it."""


def differences(connection: RobotConnection, robot: RobotConfig) -> list[str]:
    """Return how the robot file differs from what the robot that runs says, in words. Empty where base is silent."""
    answer = ask_base(connection).wait(time.monotonic() + _PATIENCE)
    told = {param.name.removeprefix("robot."): param.value for param in answer.params} if answer else {}
    return [
        f"{name} is {getattr(robot, name):g} in the robot file of this machine and {told[name]} in the robot"
        for name in _COMPARED
        if name in told and told[name] != getattr(robot, name)
    ]
