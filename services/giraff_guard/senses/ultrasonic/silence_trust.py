"""How far a sensor's silence is believed: one that is deaf says what one in the open says.

Beside another robot it says more: a deaf sensor takes that robot's pings for its own echoes. They come at any time, at
one that stays or at one that drifts, and follow this robot's motion by chance alone.
"""

import math
from collections import deque
from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_guard.config import GuardConfig
from giraff_guard.motion import RecentTravel
from giraff_schemas.messages import RobotTime

_KEPT: Final = 16
"""Readings that are compared with the newest, 2.9 s of a sensor that is pinged 5.6 times a second."""
_CAME: Final = 0.20
"""m of way along the sensor's axis between the older echo and the newest. The ping of a robot ahead goes one way:
a deaf sensor hears it come nearer by half of its own way, which 0.06 m cannot tell from the whole of it."""
_AGREE: Final = 2
"""Echoes that have to agree with the newest."""
_SHARE: Final = 4
"""One in so many of the readings since the older echo has to agree."""
_TOLERANCE: Final = 0.03
"""m between a distance and what the robot's motion explains."""
_SLANTED: Final = 0.1
"""Share of the way by which a slanted wall may come nearer more slowly than the robot moves."""
_TURNED: Final = 0.5
"""m of distance by m and rad: a slanted wall moves so as the robot turns."""


class Ping(NamedTuple):
    """A good reading, and where the robot was when it was taken."""

    robot_ns: int
    distance: float
    """m from the sensor; its reach where nothing answered."""
    echo: bool
    place: Pose


class _Proof(NamedTuple):
    robot_ns: int
    travel: float
    turned: float


class SilenceTrust:
    """The trust in the silence of one sensor. It ends by time, by turns and by way after what the sensor heard last.

    Any surface that is heard twice proves that a sensor hears something. Only echoes that follow the robot's own motion
    show that it hears itself. Without them the same way ends the trust, whatever is heard. Each epoch begins with it.
    """

    def __init__(self, live: Live[GuardConfig]) -> None:
        self._live = live
        self._proof: _Proof | None = None
        self._own_travel = 0.0
        """m that the robot had come when the sensor's own echoes were told from others' last."""

    def prove(self, robot_ns: int, motion: RecentTravel, *, own: bool) -> None:
        """It heard one surface twice, the last time at `robot_ns`. `own`: by its own pings, as far as can be told."""
        if own:
            self._own_travel = motion.travel
        self._proof = _Proof(robot_ns, motion.travel, motion.turned)

    def distrust(self, motion: RecentTravel, now: RobotTime) -> float:
        """How little its silence is worth by now: 0 as much as an echo, 1 no more than `untrusted_speed`."""
        config, proof = self._live.config, self._proof
        if proof is None:
            return 1.0
        silent = motion.travel - proof.travel + config.trust_full_turn * (motion.turned - proof.turned)
        way = max(silent, motion.travel - self._own_travel)
        by_way = (way - config.trust_full_travel) / (config.trust_end_travel - config.trust_full_travel)
        since = (now.robot_ns - proof.robot_ns) * 1e-9
        by_time = (since - config.trust_full_time) / (config.trust_end_time - config.trust_full_time)
        return min(1.0, max(0.0, by_way, by_time))


class OwnEchoes:
    """Tells the echoes of a sensor's own pings from those of another robot: they follow this robot's motion."""

    def __init__(self, axis: float) -> None:
        """`axis`: rad from the robot's heading at which the sensor looks."""
        self._axis = axis
        self._kept: deque[Ping] = deque(maxlen=_KEPT)

    def on_ping(self, ping: Ping) -> bool:
        """Return whether a reading and those before it can only be echoes of the sensor's own pings, but by chance.

        A robot that rests learns nothing. A person's walk explains nothing here: a ping that drifts looks like one.
        """
        earlier = list(self._kept)
        self._kept.append(ping)
        if not ping.echo:
            return False
        agreeing = 0
        for readings, each in enumerate(reversed(earlier), start=1):
            came = each.place.ahead(ping.place, self._axis)
            off = abs(ping.distance - each.distance + came)
            turned = abs(math.remainder(ping.place.yaw - each.place.yaw, math.tau))
            if each.echo and off <= _TOLERANCE + _SLANTED * abs(came) + _TURNED * each.distance * turned:
                agreeing += 1
                if agreeing >= _AGREE and _SHARE * agreeing >= readings and abs(came) >= max(_CAME, 2.0 * off):
                    return True
        return False
