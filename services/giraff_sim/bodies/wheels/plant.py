"""The robot's body: what the motors make of their drive, and where that takes it. SI units.

The motion is integrated in steps of a millisecond from the true wheels' speeds, not by the formulas of any service nor
by the robot file's geometry, so that an error there shows.
"""

import math
from typing import Final

from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.robot import RobotConfig
from giraff_sim.config import SimConfig
from giraff_sim.truth import EXACT, TrueWheel, Truth
from giraff_sim.world.bno055 import GRAVITY
from giraff_sim.world.disc import Disc
from giraff_sim.world.room import Pose, Room

_FULL_DUTY: Final = 255.0
_FLICKER_S: Final = 0.02  # from one edge to the next of an encoder that stands on it
_SLIPPING: Final = 0.5  # share of its turning that a wheel loses while it slips


class Wheel:
    """A motor on an H bridge, its wheel and its encoder."""

    def __init__(self, robot: RobotConfig, drive: WheelsConfig, sim: SimConfig, true: TrueWheel) -> None:
        self.speed = 0.0
        """m/s of its true rim, forward positive."""
        self.travel = 0.0
        """m that the rim has truly turned so far, forward positive."""
        self.is_blocked = False
        """It does not turn, whatever the motor gets."""
        self.brake = 0.0
        """m/s² by which something holds it back, as a hand does."""
        self.lost_share = 0.0
        """Share of its turning that the encoder does not count, as on a shaft that slips."""
        self._lost = 0.0  # m of travel that were not counted
        self.flickers = False
        """Its encoder stands on the edge of a count whenever the wheel rests, and counts to and fro."""
        self._clock = 0.0  # s
        self._lag = sim.motor_time_constant
        self._friction = sim.wheel_friction
        self._drag = true.drag
        self._dead_zone = sim.dead_zone_counts
        self._speed_per_count = robot.max_wheel_speed / drive.max_level * true.strength * true.scale
        states_per_tick = drive.board_type.states_per_tick
        self._states_per_metre = robot.ticks_per_metre * states_per_tick / true.scale
        self._first_state = true.phase * states_per_tick
        self._threshold_slip = true.threshold_slip
        self._slip_left = 0.0  # m that it still turns in vain

    @property
    def states(self) -> float:
        """Position of the encoder, in quadrature states."""
        states = self._first_state + (self.travel - self._lost) * self._states_per_metre
        if not self.flickers or self.speed != 0.0 or int(self._clock / _FLICKER_S) % 2:
            return states
        return (math.floor(states) ^ 1) + 0.5  # beyond the edge of A that is next to it

    @property
    def counted_speed(self) -> float:
        """m/s of the rim, as far as the encoder counts it."""
        return self.speed * (1.0 - self.lost_share)

    def meet_threshold(self) -> None:
        """It comes upon one, and slips."""
        self._slip_left = self._threshold_slip

    def grip(self, duration: float) -> float:
        """m/s at which it carries the body through these `duration` s: less than its rim's while it slips."""
        if self._slip_left <= 0.0:
            return self.speed
        lost = min(self._slip_left, _SLIPPING * abs(self.speed) * duration)
        self._slip_left -= lost
        return self.speed - math.copysign(lost / duration, self.speed)

    def step(self, duration: float, duty: float, voltage_ratio: float, push: float = 0.0) -> None:
        """Turn for `duration` s with a signed duty of 255, the battery at `voltage_ratio` of nominal.

        `push`: m/s² by which the slope speeds its rim up, forward positive.

        The drive that holds a speed is measured with friction in it: level 70 stands for 0.6 m/s of a turning
        wheel, not of a free shaft. So the friction shows where the drive ends.
        """
        self._clock += duration
        if self.is_blocked:
            self.speed = 0.0
            return
        effective = duty * voltage_ratio
        if abs(effective) < self._dead_zone:
            aim = 0.0
        else:
            aim = effective * self._speed_per_count + math.copysign(self._friction * self._lag, effective)
        pull = (aim - self.speed) / self._lag + push
        slide = self.speed or pull
        held = self._friction + self._drag + self.brake
        if self.speed == 0.0 and abs(pull) <= held:
            return
        speed = self.speed + (pull - math.copysign(held, slide)) * duration
        if self.speed * speed < 0.0:
            speed = 0.0  # friction stops a wheel, it does not turn it back
        step = (self.speed + speed) / 2.0 * duration
        self.travel += step
        if self.lost_share:
            self._lost += self.lost_share * step
        self.speed = speed


class Plant(Disc):
    """Two driven wheels under a disc that walls and posts stop. The body stops; the wheels then slip."""

    def __init__(
        self, robot: RobotConfig, drive: WheelsConfig, sim: SimConfig, room: Room, truth: Truth = EXACT
    ) -> None:
        super().__init__(room, robot.footprint_radius)
        self.left = Wheel(robot, drive, sim, truth.left)
        self.right = Wheel(robot, drive, sim, truth.right)
        self.speed = 0.0
        """m/s at which the wheels carry the centre, forward positive; something in the way may hold it all the same."""
        self.turn = 0.0
        """rad/s at which they turn the body, counter-clockwise positive."""
        self.open_volts = sim.battery_volts
        """V of the battery with nothing connected."""
        self.volts = sim.battery_volts
        """V of the battery now."""
        self._track_width = robot.track_width * truth.track_scale
        self._turn_grip = 1.0 - truth.turn_slip
        self._nominal_volts = drive.battery_nominal
        self._sag_volts = sim.battery_sag_volts
        self._downhill = GRAVITY * math.sin(math.radians(sim.slope_deg))  # m/s² along -x

    def step(self, duration: float, left_duty: float, right_duty: float) -> None:
        """Move for `duration` s with each motor's signed duty, of 255."""
        load = (abs(left_duty) + abs(right_duty)) / (2.0 * _FULL_DUTY)
        self.volts = max(0.0, self.open_volts - load * self._sag_volts)
        ratio = self.volts / self._nominal_volts
        push = -self._downhill * math.cos(self.pose.yaw) if self._downhill else 0.0
        if push and self._touching and self._room.nearest(self.pose.x, self.pose.y)[1] > 0.0:
            push = 0.0  # a surface below holds the robot
        self.left.step(duration, left_duty, ratio, push)
        self.right.step(duration, right_duty, ratio, push)
        left, right = self.left.grip(duration), self.right.grip(duration)
        self.speed = (left + right) / 2.0
        self.turn = (right - left) / self._track_width * self._turn_grip
        if self.speed != 0.0 or self.turn != 0.0 or self._room.version != self._room_version:
            before = self.pose
            self._move(self.speed * duration, self.turn * duration)
            if self._room.thresholds:
                self._meet_thresholds(before)

    def place(self, pose: Pose) -> None:
        super().place(pose)
        self.left.speed = self.right.speed = self.speed = self.turn = 0.0

    def _meet_thresholds(self, before: Pose) -> None:
        for wheel, side in ((self.left, 0.5), (self.right, -0.5)):
            aside = side * self._track_width
            if self._room.is_threshold_between(_beside(before, aside), _beside(self.pose, aside)):
                wheel.meet_threshold()


def _beside(pose: Pose, aside: float) -> tuple[float, float]:
    """The point `aside` m to the left of a pose."""
    return pose.x - aside * math.sin(pose.yaw), pose.y + aside * math.cos(pose.yaw)
