"""The part of the guard that sets a sensor up: how far it judges an obstacle to be."""

import math

from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_guard.config import GuardConfig
from giraff_guard.limits import SIGN, Limits
from giraff_guard.senses.ultrasonic.facing import Facing
from giraff_guard.senses.ultrasonic.sensor import Sensor


def distances(robot: RobotConfig, name: str, guard: GuardConfig, echo: float, came: float) -> tuple[float, ...]:
    """Return m by which the guard judges an obstacle: straight ahead, at its worst slant, and where it remembers it.

    `echo`: m, without a scale. `came`: m of way since. A sensor beside others is judged with them.
    """
    live = Live(guard)
    limits = Limits(live, robot)
    sensors = {each: Sensor(each, pose, live) for each, pose in robot.of(Ultrasonic).items()}
    sensor, pose = sensors[name], sensors[name].pose
    distance = echo * pose.scale
    remembered = min(distance, max(guard.memory_range, guard.silent_range))
    judged = [sensor.offset + distance - came * abs(math.cos(pose.yaw))]
    for way, sign in SIGN.items():
        facing = Facing(way, limits, list(sensors.values()))
        if sensor in facing.sensors:
            worst = facing.gap(sensor, distance)
            judged += [
                worst - came * abs(math.cos(pose.yaw)),
                sign * (pose.x + remembered * math.cos(pose.yaw)),
            ]
    return tuple(judged)
