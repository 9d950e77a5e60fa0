"""A second cloud that begins anywhere every few metres, and is weighed against the first by what each makes likely.

That is how the filter finds out that it was wrong, or that the robot was carried away: particles come back where the
last metres of readings fit, never at random everywhere.
"""

import math
from collections.abc import Callable
from typing import Final

from giraff_localization.cloud import Cloud

_LEAST: Final = 0.1
"""Of its particles, that it keeps at least."""
_WINDOW: Final = 10.0
"""m after which it is over."""
SETTLES: Final = 4.0
"""m before it says anything."""
_WINS: Final = 3.0
"""Nats by which it must be ahead to take over."""
_MODEST: Final = 2.0
"""Nats that it is taken to be behind where both are mixed."""
_SOME: Final = 0.01
_GAIN: Final = 0.5
"""What it hears counts half: it keeps more places for longer."""
_LEARNED: Final = 5.0
"""m after which the first cloud knows something of the wheels."""


class RestartCloud:
    """Of one search."""

    def __init__(self, anywhere: Callable[[int], Cloud], count: int) -> None:
        """`anywhere`: makes so many particles, each place as likely as any other; `count`: that it begins with."""
        self._anywhere, self._count = anywhere, count
        self.cloud: Cloud | None = None
        self.since = 0.0
        """m since it began."""
        self.lead = 0.0
        """Nats by which the first cloud is ahead of it."""

    @property
    def is_settled(self) -> bool:
        return self.cloud is not None and self.since > SETTLES

    def begin(self, main: Cloud, total: float) -> None:
        """Start one, where none is. `total`: m that the search has come."""
        if self.cloud is None:
            self.cloud = self._anywhere(self._count)
            self.cloud.gain = _GAIN
            if total > _LEARNED:
                self.cloud.learn_scales(main)
            main.evidence = self.since = 0.0

    def judge(self, main: Cloud, effort: float) -> Cloud:
        """After both have moved and heard: the cloud that goes on as the first."""
        cloud = self.cloud
        if cloud is None:
            return main
        cloud.resample(round(_LEAST * self._count), self._count)
        self.since += effort
        self.lead = main.evidence - cloud.evidence
        if self.is_settled and -self.lead > _WINS:
            cloud.gain, self.cloud, self.lead = 1.0, None, 0.0
            return cloud
        if self.since > _WINDOW:
            share = 1.0 / (1.0 + math.exp(min(50.0, self.lead + _MODEST)))
            if share > _SOME:
                main.join(cloud, share)
            self.cloud = None
        return main
