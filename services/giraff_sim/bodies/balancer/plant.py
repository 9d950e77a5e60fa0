"""The motion of a robot that balances: an inverted pendulum on two wheels with motors. SI units.

The bodies are the chassis (way, lean, yaw), two wheels and two rotors. A gear with play joins rotor and wheel. An
elastic tyre that can slip joins wheel and floor. Encoder and friction are on the rotor's side of the play. The motor
driver sets volts, not torque. Forward, leaning forward and turning left are positive.
"""

import math
from typing import Final

from giraff_base.drives.balancer.config import GRAVITY
from giraff_sim.bodies.balancer.drawn import AMPERES, Drawn
from giraff_sim.bodies.balancer.people import Loads
from giraff_sim.world.disc import Disc
from giraff_sim.world.room import Pose, Room

STEP: Final = 0.001
"""s. The stiffest mode, of tyre and wheel, is at 40 Hz."""
MAST: Final = 1.1
"""m from the axle to the top of the mast."""
_GEAR_STIFFNESS: Final = 3000.0  # N m/rad
_GEAR_DAMPING: Final = 6.0  # N m s/rad
_TYRE_STIFFNESS: Final = 30_000.0  # N/m
_TYRE_DAMPING: Final = 220.0  # N s/m
_CASTER_STIFFNESS: Final = 2000.0  # N m/rad
_CASTER_DAMPING: Final = 60.0  # N m s/rad
_CASTER_ARM: Final = 0.30  # m from the axle
_CASTER_DRAG: Final = 0.05  # of its load
_SCRUB: Final = 3.0  # N m by which the tyres resist a turn on the spot
_STICTION: Final = 1.25  # of the dry friction, at rest
_REST: Final = 0.02  # rad/s
_RAISING: Final = 0.5  # rad/s at which a person raises it


def _slid(speed: float, drive: float, inertia: float, friction: float) -> float:
    """Return the next speed of a body under the force `drive` and dry friction. It sticks at zero."""
    free = speed + drive / inertia * STEP
    rest = abs(free) - friction / inertia * STEP
    return math.copysign(rest, free) if rest > 0.0 else 0.0


class Wheel:
    """A motor, its gear, its wheel and its tyre. Angles: rad, of the wheel, or of the rotor as seen at the wheel."""

    __slots__ = (
        "_constant",
        "_friction",
        "_grip",
        "_half_play",
        "_load_loss",
        "_ohm",
        "_radius",
        "_rolling",
        "_rotor",
        "_tyre",
        "_wheel",
        "amperes",
        "angle",
        "is_blocked",
        "rate",
        "rotor_angle",
        "rotor_rate",
        "speed",
        "tension",
        "traction",
    )

    def __init__(self, drawn: Drawn, number: int) -> None:
        self.angle = 0.0
        self.rate = 0.0
        self.rotor_angle = 0.0
        """rad against the chassis: what the encoder counts."""
        self.rotor_rate = 0.0
        self.speed = 0.0
        """m/s of its rim, forward positive."""
        self.is_blocked = False
        """It does not turn, whatever the motor does."""
        self.amperes = 0.0
        self.tension = 0.0
        """N m by which the gear turns the wheel and tips the chassis back."""
        self.traction = 0.0
        """N by which the floor pushes it forward."""
        self._tyre = 0.0  # m that the tyre is wound up
        self._constant = drawn.constant[number]
        self._ohm = drawn.ohm[number]
        self._friction = drawn.friction[number]
        self._load_loss = drawn.load_loss[number]
        self._half_play = drawn.play[number] / 2.0
        self._grip = drawn.grip
        self._radius = drawn.radius
        self._rolling = drawn.rolling
        self._rotor = drawn.rotor_inertia
        self._wheel = drawn.wheel_inertia

    def step(self, volts: float | None, load: float, speed: float, lean: float, lean_rate: float) -> None:
        """Turn for a step. `volts` of the bridge, None while it is open; `speed` of the floor's point below the hub."""
        rotor_rate, rate = self.rotor_rate, self.rate
        amperes = 0.0
        if volts is not None:
            amperes = min(AMPERES, max(-AMPERES, (volts - self._constant * rotor_rate) / self._ohm))
        self.amperes = amperes
        # Teeth push, they do not pull.
        wind = self.rotor_angle - (self.angle - lean)
        slip = rotor_rate - (rate - lean_rate)
        tension = 0.0
        if wind > self._half_play:
            tension = max(0.0, _GEAR_STIFFNESS * (wind - self._half_play) + _GEAR_DAMPING * slip)
        elif wind < -self._half_play:
            tension = min(0.0, _GEAR_STIFFNESS * (wind + self._half_play) + _GEAR_DAMPING * slip)
        self.tension = tension
        slip = self._radius * rate - speed
        most = self._grip * load
        wound = most / _TYRE_STIFFNESS
        self._tyre = min(wound, max(-wound, self._tyre + slip * STEP))
        traction = min(most, max(-most, _TYRE_STIFFNESS * self._tyre + _TYRE_DAMPING * slip))
        self.traction = traction
        friction = self._friction * (_STICTION if abs(rotor_rate) < _REST else 1.0) + self._load_loss * abs(tension)
        self.rotor_rate = _slid(rotor_rate, self._constant * amperes - tension, self._rotor, friction)
        if self.is_blocked:
            self.rate = 0.0
        else:
            held = self._rolling * load * self._radius
            self.rate = _slid(rate, tension - traction * self._radius, self._wheel, held)
        self.speed = self._radius * self.rate

    def turn_on(self) -> None:
        """Advance the angles by a step, after the chassis has its new speeds."""
        self.angle += self.rate * STEP
        self.rotor_angle += self.rotor_rate * STEP

    def stop(self) -> None:
        self.rate = self.rotor_rate = self.speed = 0.0


class Plant(Disc):
    """One robot on its floor, in its room. A surface of the room stops it at the height of the axle."""

    def __init__(self, drawn: Drawn, room: Room, radius: float) -> None:
        super().__init__(room, radius)
        self.drawn = drawn
        self.loads = Loads()
        self.left, self.right = Wheel(drawn, 0), Wheel(drawn, 1)
        self.way = 0.0
        """m that the axle has gone forward."""
        self.speed = 0.0
        """m/s of the axle, forward positive."""
        self.acceleration = 0.0
        self.pivot = drawn.radius
        self.lean_rate = 0.0
        self.lean_acceleration = 0.0
        self.turned = 0.0
        """rad that it has turned left."""
        self.turn = 0.0
        """rad/s."""
        self.grade = 0.0
        """rad by which the axle's path rises."""
        self.touch = 0.0
        """N by which a person who holds it pushes it forward, beside a push."""
        self.seconds = 0.0
        self.falls = 0
        """How often it came to lie on a caster."""
        self.landed = 0.0
        """m/s of the mast's top when it last did so."""
        self._lies = False
        self.open_volts = self.volts = drawn.open_volts
        self._total = drawn.body_mass + 2.0 * drawn.wheel_mass
        self._moment = drawn.body_mass * drawn.centre_height
        self._about_axle = drawn.body_inertia + drawn.body_mass * drawn.centre_height**2

    def lean_to(self, lean: float) -> None:
        """Set it at rest at this lean, the wheels unturned."""
        self.left.rotor_angle -= lean - self.lean
        self.right.rotor_angle -= lean - self.lean
        self.lean, self.lean_rate = lean, 0.0

    def place(self, pose: Pose) -> None:
        super().place(pose)
        self.speed = self.turn = self.lean_rate = self.acceleration = self.lean_acceleration = 0.0
        self.left.stop()
        self.right.stop()

    def step(self, left_share: float, right_share: float, *, is_open: bool) -> None:
        """Move for STEP. Shares: of the battery's volts, -1..1, that the bridges give; `is_open`: they give none."""
        drawn, loads, left, right = self.drawn, self.loads, self.left, self.right
        lean, lean_rate, speed, turn = self.lean, self.lean_rate, self.speed, self.turn
        sin, cos = math.sin(lean), math.cos(lean)
        grade = loads.slope
        if loads.threshold is not None:
            grade += math.atan(loads.threshold.rise(self.way, drawn.radius))
        self.grade = grade
        touch = height = 0.0
        if (spring := loads.spring) is not None:
            height = spring.height
            touch = spring.force(self.way + height * sin, speed + height * cos * lean_rate)
        self.touch = touch
        weight = self._total * GRAVITY
        stop = self._stop_of_casters()
        on_caster = abs(stop) / _CASTER_ARM
        load = max(0.0, (weight * math.cos(grade) - on_caster) * (1.0 - loads.lift)) / 2.0
        half_turn = drawn.track / 2.0 * turn
        volts = self.volts
        left.step(None if is_open else left_share * volts, load, speed - half_turn, lean, lean_rate)
        right.step(None if is_open else right_share * volts, load, speed + half_turn, lean, lean_rate)
        self.volts = self.open_volts - drawn.battery_ohm * (left_share * left.amperes + right_share * right.amperes)
        # The chassis: two coupled equations, of the way and of the lean.
        tension = left.tension + right.tension
        forward = left.traction + right.traction - weight * math.sin(grade) + loads.force + touch
        forward += self._moment * lean_rate**2 * sin
        if stop:
            forward -= _CASTER_DRAG * on_caster * math.tanh(speed / 0.02)
        tips = self._moment * GRAVITY * sin - tension + (loads.force * loads.height + touch * height) * cos
        tips += loads.bag + stop
        across, about = self._moment * cos, self._about_axle
        det = self._total * about - across * across
        self.acceleration = (about * forward - across * tips) / det
        self.lean_acceleration = (self._total * tips - across * forward) / det
        if loads.lift > 0.5:
            self._carry(tension)
        if loads.grip is None:
            self.speed = speed + self.acceleration * STEP
            self.lean_rate = lean_rate + self.lean_acceleration * STEP
        else:
            self.speed = self.acceleration = self.lean_acceleration = 0.0
            self.lean_rate = min(_RAISING, max(-_RAISING, (loads.grip - lean) / STEP))
        torque = (right.traction - left.traction) * drawn.track / 2.0
        self.turn = _slid(turn, torque, drawn.yaw_inertia, _SCRUB * (1.0 - loads.lift))
        self._roll()
        self.lean += self.lean_rate * STEP
        self.turned += self.turn * STEP
        left.turn_on()
        right.turn_on()
        self.seconds += STEP

    def _stop_of_casters(self) -> float:
        """Return the N m by which a caster that touches the floor holds the body up."""
        against_floor = self.lean + self.grade
        over = abs(against_floor) - self.drawn.caster
        if over <= 0.0:
            self._lies = self._lies and abs(against_floor) > self.drawn.caster / 2.0
            return 0.0
        if not self._lies:
            self._lies = True
            self.falls += 1
            self.landed = self.speed + MAST * self.lean_rate
        side = math.copysign(1.0, against_floor)
        return -side * max(0.0, _CASTER_STIFFNESS * over + _CASTER_DAMPING * side * self.lean_rate)

    def _carry(self, tension: float) -> None:
        """Change the acceleration where a person carries it by the mast: it sways and does not roll."""
        self.acceleration = -20.0 * self.speed
        swing = self.lean - 0.05 * math.sin(2.5 * self.seconds)
        self.lean_acceleration = (-60.0 * swing - 12.0 * self.lean_rate - tension) / self._about_axle

    def _roll(self) -> None:
        before, distance = self.pose, self.speed * STEP
        self._move(distance, self.turn * STEP)
        if self._touching:
            middle = before.yaw + self.turn * STEP / 2.0
            gone = (self.pose.x - before.x) * math.cos(middle) + (self.pose.y - before.y) * math.sin(middle)
            if gone * distance < distance * distance:
                # The surface takes the speed at the axle by an impulse, which also tips the body.
                lost, distance = (gone - distance) / STEP, gone
                self.speed += lost
                self.lean_rate -= self._moment * math.cos(self.lean) / self._about_axle * lost
        self.way += distance
