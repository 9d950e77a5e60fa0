"""The table `[web]` of the robot file."""

from typing import Annotated, ClassVar

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.tilt.curves import Curve
from giraff_core.tuning import Tuning
from giraff_schemas.topics import require_chunk


class WebConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where the page is served, and how fast it drives."""

    LIVE: ClassVar = Tuning.READ_ONLY

    operator: str = "web"
    """Name under which this operator's commands are published: `cmd_vel/<operator>`."""
    address: str = ""
    """Address of this host at which browsers call; empty: every one that it has."""
    port: Annotated[int, Bounds(0, 65535)] = 8443
    """TCP port; 0: any that is free."""
    names: tuple[str, ...] = ()
    """Further names and addresses at which browsers reach this host, as a DNS name of the network: they go into the
    certificate, and pages of other names are refused."""
    most_watchers: Annotated[int, Bounds(1, 500)] = 24
    """Pages that are open at once, beside those that may drive."""
    slow_speed: Annotated[float, Bounds(0.02, 0.3, "m/s")] = 0.3
    """m/s at most of the touch pad and the keys, whose turn is the same share of the robot's."""
    curve: Curve = "angle"
    """Of a tilted phone, as of the joystick."""
    dead_zone_deg: Annotated[float, Bounds(2.0, 30.0, "degrees")] = 8.0
    """Degrees from the attitude at the touch within which a phone moves nothing."""
    full_tilt_deg: Annotated[float, Bounds(10.0, 80.0, "degrees")] = 35.0
    """Degrees at which a phone asks for full speed."""
    room: str = ""
    """Path of a room's walls in the frame `odom`, JSON as `giraff_web.messages.Room`; empty: none is shown."""

    def __post_init__(self) -> None:
        require_chunk(self.operator)
        check_bounds(self)
        if self.address in ("0.0.0.0", "::"):  # noqa: S104  it is refused
            raise ValueError(f"address is {self.address}, which no browser can ask for: leave it empty for every one")
        if self.full_tilt_deg <= self.dead_zone_deg:
            raise ValueError(
                f"dead_zone_deg is {self.dead_zone_deg} and full_tilt_deg {self.full_tilt_deg}: "
                "they must grow in that order"
            )
