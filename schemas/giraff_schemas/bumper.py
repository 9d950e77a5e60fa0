"""What the bumpers say."""

from giraff_schemas.messages import RobotTime, Sample


class Bump(Sample, frozen=True, kw_only=True):
    """Whether something pushes one bumper, each time that this changes, and all the time between."""

    sensor: str
    """Name in the robot file, as in the key."""
    pressed: bool
    """Its switch is open: something pushes it, or its wire is off."""
    tick: RobotTime | None
    """Newest moment the board held when it read the switch."""
