"""Who holds the joystick of a run: the demonstration as long as nobody else drives, or nobody."""

from __future__ import annotations

from giraff_cli.run.demonstration import DRIVES, FLAT, Demonstration
from giraff_cli.run.simulated_robot import SimulatedRobot
from giraff_schemas.messages import Sample


class Joystick:
    """Times are monotonic, s."""

    def __init__(self, robot: SimulatedRobot, *, is_driven: bool) -> None:
        """`is_driven`: by the demonstration; else it lies flat all the time."""
        self._robot = robot
        self._demonstration = Demonstration()
        self._grip = DRIVES if is_driven else FLAT
        if not is_driven:
            self._demonstration.end()

    @property
    def note(self) -> str:
        """What a person is told of it; empty: nothing."""
        return self._demonstration.note

    def on_sample(self, sample: Sample, now: float) -> None:
        """Take anything that is heard of the robot."""
        self._demonstration.on_sample(sample, now)

    def hold(self, now: float) -> None:
        """Have it held as is due now. Raises SimulatorError."""
        grip = self._demonstration.grip(now)
        if grip != self._grip:
            self._robot.hold_joystick(grip)
            self._grip = grip

    def lay_flat(self) -> None:
        """For good. Raises SimulatorError."""
        self._demonstration.end()
        self.hold(0.0)
