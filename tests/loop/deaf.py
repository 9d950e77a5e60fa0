"""Drives in which ultrasonic sensors go deaf, by an operator who pushes on: how fast is what touched?

Usage: python -m tests.loop.deaf FROM TO: the drives of these seeds, those that break a bound, and a summary.
"""

import math
import random
import sys
from collections.abc import Iterable, Iterator
from typing import Final

import msgspec

from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.config import SimConfig
from giraff_sim.world.bno055 import Vector
from giraff_sim.world.hand import LEVEL
from giraff_sim.world.room import Pose, Room
from giraff_sim.world.sonar import SonarFault
from tests.loop.deaf_drives import Act, Drive, drawn_drive
from tests.loop.loops import COARSE_STEP_US, arm, closed_loop, drawn, spare_time
from tests.loop.reaction import WILD_SHARE, tilted
from tests.loop.rooms import Wrist
from tests.loop.touches import Kind, Touch, Touches
from tests.support.robots import ROBOT, ULTRASONIC

BOUNDS: Final = {Kind.HEARD: 0.16, Kind.WOULD: 0.20}
"""m/s at a touch."""
FASTER: Final = (0.16, 0.20, 0.30)
_BEGINS: Final = 2.0  # s
_TURN_S: Final = 0.04  # between two wishes of the hand
_LONGEST: Final = 90.0  # s
_TOUCHES: Final = 3  # after which a drive has shown what it can
_STUCK: Final = 0.05  # m; less in some s is not getting on
_RESTED: Final = 25.0  # s, and until it begins: who rested longer has to ask, and be level, before it drives again
_PATIENCE: Final = 12.0  # s for any other act than parking and pushing

Wish = tuple[float, float]
"""m/s, rad/s."""
_FULL: Final = ROBOT.max_wheel_speed


class Outcome(msgspec.Struct, frozen=True):
    """What became of a drive."""

    drive: Drive
    touches: tuple[Touch, ...]
    seconds: float
    way: float
    """m driven with a deaf sensor."""

    @property
    def breaks(self) -> list[Touch]:
        """Touches faster than their bound."""
        return [touch for touch in self.touches if touch.speed > BOUNDS.get(touch.kind, math.inf)]


class _Hand:
    """Does what is wished as a wrist can."""

    trembles = True

    def __init__(self) -> None:
        self.meant: Vector = LEVEL
        self._wrist = Wrist()

    def acceleration(self, seconds: float, robot: Pose) -> Vector:
        del robot
        return self._wrist.towards(self.meant, seconds)


class Operator:
    """Does one act after the other, whatever the guard says; sees only where the robot is."""

    def __init__(self, loop: ClosedLoop, drive: Drive) -> None:
        self._plant = loop.simulation.world.plant
        self._loop = loop
        self._drive = drive
        self._choose = random.Random(f"{drive.seed}/operator")
        self._last: Wish = 0.0, 0.0
        self._tilted_at = self._seconds

    def wishes(self) -> Iterator[tuple[Act, Wish]]:
        """What the hand does and asks for, one each 0.04 s, until all is done."""
        for act in self._drive.acts:
            for wish in self._wishes(act):
                self._last = wish
                if wish != (0.0, 0.0):
                    self._tilted_at = self._seconds
                yield act, wish

    def _wishes(self, act: Act) -> Iterator[Wish]:
        if act.what not in {"park", "cover"} and self._seconds - self._tilted_at > _RESTED:
            yield from [(self._drive.sign * _FULL, 0.0)] * 15 + [(0.0, 0.0)] * 25
        match act.what:
            case "drive":
                yield from self._straight(act.amount, 1.0)
            case "back":
                yield from self._straight(act.amount, -1.0)
            case "turn":
                yield from self._turn(act.amount, 0.0)
            case "curve":
                yield from self._turn(act.amount, 0.4 * _FULL)
            case "park":
                end = self._seconds + act.amount
                while self._seconds < end:
                    yield 0.0, 0.0
            case "push":
                yield from self._push(self._seconds + act.amount)
            case "cover":
                yield self._last

    def _straight(self, way: float, sign: float) -> Iterator[Wish]:
        """On or back, until it has come so far or does not get on."""
        begin, yaw, end = self._plant.path_length, self._plant.pose.yaw, self._seconds + _PATIENCE
        got_on = begin, self._seconds
        while self._plant.path_length - begin < way and self._seconds < end:
            if self._plant.path_length - got_on[0] > _STUCK:
                got_on = self._plant.path_length, self._seconds
            if self._seconds - got_on[1] > 1.5:
                return
            yield self._drive.sign * sign * _FULL, self._steering(yaw)

    def _turn(self, angle: float, linear: float) -> Iterator[Wish]:
        turned, yaw, end = 0.0, self._plant.pose.yaw, self._seconds + _PATIENCE
        while abs(turned) < abs(angle) and self._seconds < end:
            yield self._drive.sign * linear, math.copysign(1.0, angle)
            turned += math.remainder(self._plant.pose.yaw - yaw, math.tau)
            yaw = self._plant.pose.yaw

    def _push(self, end: float) -> Iterator[Wish]:
        """Full tilt; where it does not get on, it pushes on, turns a little, or backs up and comes again."""
        choose = self._choose
        while self._seconds < end:
            yaw, got_on = self._plant.pose.yaw, (self._plant.path_length, self._seconds)
            patience = choose.uniform(1.0, 5.0)
            aside, change = 0.0, self._seconds + choose.uniform(1.0, 5.0)
            while self._seconds < end and self._seconds - got_on[1] < patience:
                if self._plant.path_length - got_on[0] > _STUCK:
                    got_on = self._plant.path_length, self._seconds
                if self._seconds > change:
                    aside = 0.0 if aside else choose.uniform(-0.5, 0.5)
                    yaw, change = self._plant.pose.yaw, self._seconds + choose.uniform(0.3, 1.0 if aside else 6.0)
                yield self._drive.sign * _FULL, aside or self._steering(yaw)
            match choose.choice(("push", "turn", "back", "back")):
                case "turn":
                    yield from self._turn(math.radians(choose.uniform(-40.0, 40.0)), 0.0)
                case "back":
                    yield from self._straight(choose.uniform(0.2, 0.8), -1.0)
                case _:
                    pass

    def _steering(self, yaw: float) -> float:
        if not self._drive.keeps_heading:
            return 0.0
        return max(-0.5, min(0.5, 1.5 * math.remainder(yaw - self._plant.pose.yaw, math.tau)))

    @property
    def _seconds(self) -> float:
        return self._loop.simulation.now_us * 1e-6


class _Membranes:
    """Of the sensors that are to be deaf: each hears some pings and not others, until it is covered."""

    def __init__(self, loop: ClosedLoop, drive: Drive) -> None:
        self._sonars = [loop.simulation.world.sonars[ULTRASONIC[name].index] for name in drive.deaf]
        self._sound = {sonar: sonar.fault for sonar in self._sonars}
        self._hears = drive.hears
        self._are_covered = False

    def cover(self) -> None:
        """From now on nothing is heard."""
        self._are_covered = True
        for sonar in self._sonars:
            sonar.fault = SonarFault.DEAF

    def next_ping(self) -> None:
        """After each step of the loop."""
        if self._are_covered or not self._hears:
            return
        for sonar in self._sonars:
            hears = self._hears[sonar.pings % len(self._hears)]
            sonar.fault = self._sound[sonar] if hears else SonarFault.DEAF


def run(seed: int, *, deaf: bool = True, until: float = _LONGEST) -> Outcome:
    """Drive the drive of this seed; `deaf` False: the same with sensors that stay sound."""
    return run_drive(*drawn_drive(seed), deaf=deaf, until=until)


def run_drive(drive: Drive, room: Room, *, deaf: bool = True, until: float = _LONGEST) -> Outcome:
    """Drive it there. `until`: simulated s at which it ends at the latest."""
    seed = drive.seed
    with closed_loop(room, sim=SimConfig(), seed=seed, truth=drawn(seed)) as loop:
        spare_time(loop)
        arm(loop)
        loop.run(_BEGINS - loop.simulation.now_us * 1e-6)
        world, hand, operator = loop.simulation.world, _Hand(), Operator(loop, drive)
        world.hand = hand
        if drive.is_wild:
            for sonar in world.sonars.values():
                sonar.fault, sonar.wild_share = SonarFault.WILD_SOME, WILD_SHARE
        touches, membranes = Touches(loop, drive.deaf), _Membranes(loop, drive)
        covered = 0.0
        for act, wish in operator.wishes():
            if act.what == "cover":
                touches.is_deaf, covered = True, world.plant.path_length
                if deaf:
                    membranes.cover()
            hand.meant = tilted(*wish).acceleration(0.0, world.plant.pose)
            for _ in range(round(_TURN_S * 1e6 / COARSE_STEP_US)):
                loop.step()
                touches.note()
                if deaf:
                    membranes.next_ping()
            if len(touches.noted) >= _TOUCHES or loop.simulation.now_us >= until * 1e6:
                break
        return Outcome(
            drive=drive,
            touches=tuple(touches.noted),
            seconds=loop.simulation.now_us * 1e-6,
            way=world.plant.path_length - covered,
        )


class Figures(msgspec.Struct, frozen=True):
    """Of the touches of one kind, in any number of drives."""

    touches: int
    faster: dict[str, int]
    """By m/s: how many were faster."""
    fastest: float
    seed: int
    """Of the fastest."""


def figures(outcomes: Iterable[Outcome]) -> dict[str, Figures]:
    """By kind of touch, and of all that a sound sensor would have heard at its last ping."""
    seen = [(outcome.drive.seed, touch) for outcome in outcomes for touch in outcome.touches]
    found = {str(kind): _figures([(seed, touch) for seed, touch in seen if touch.kind is kind]) for kind in Kind}
    audible = [(seed, touch) for seed, touch in seen if touch.is_audible and touch.kind is not Kind.OTHER]
    return found | {"in the cone of a sound sensor": _figures(audible)}


def _figures(touches: list[tuple[int, Touch]]) -> Figures:
    speeds = [touch.speed for _, touch in touches]
    fastest = max(touches, key=lambda each: each[1].speed, default=None)
    return Figures(
        touches=len(touches),
        faster={f"{bound:.2f}": sum(speed > bound for speed in speeds) for bound in FASTER},
        fastest=round(max(speeds, default=0.0), 3),
        seed=-1 if fastest is None else fastest[0],
    )


def told(outcome: Outcome, touch: Touch) -> str:
    """One line about a touch."""
    return (
        f"{outcome.drive.seed}: {touch.kind}, {touch.speed:.3f} m/s at {touch.seconds:.1f} s, {touch.surface}"
        f" {math.degrees(touch.bearing):+.0f}°; {outcome.drive}"
    )


def main(first: int, end: int) -> None:
    """Print what the drives of these seeds break, and a summary."""
    outcomes = []
    for seed in range(first, end):
        outcomes.append(outcome := run(seed))
        for touch in outcome.breaks:
            print(told(outcome, touch), flush=True)
        if outcome.breaks:
            sound = run(seed, deaf=False).touches
            all_of_it = ", ".join(
                f"{touch.surface} at {touch.speed:.3f} m/s" for touch in sound if touch.kind != Kind.OTHER
            )
            print(f"  with sound sensors: {all_of_it or 'nothing'}", flush=True)
    touching = sum(any(touch.kind is not Kind.OTHER for touch in outcome.touches) for outcome in outcomes)
    print(
        f"{len(outcomes)} drives, {touching} with a touch, {sum(bool(o.breaks) for o in outcomes)} that break a bound"
    )
    for name, of in figures(outcomes).items():
        faster = ", ".join(f"{number} over {bound}" for bound, number in of.faster.items())
        print(f"{name}: {of.touches} touches, {faster}; fastest {of.fastest:.3f} m/s (seed {of.seed})")


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
