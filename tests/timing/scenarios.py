"""The fault table, a row a scenario."""

from typing import Final

from giraff_sim.world.bno055 import Bno055Fault
from giraff_sim.world.sonar import SonarFault
from tests.timing.faults import (
    BACKWARD,
    ENCODERS_FLICKER,
    ESTOP_ENGAGED,
    FORWARD,
    LEFT,
    LEVEL,
    LINK_CUT,
    LINK_SEVERED,
    OPERATORS,
    REQUESTER_KILLED,
    RIGHT,
    ROBOT_SIDE,
    TWO_AT_ONCE,
    Scenario,
    battery,
    bumper_cut,
    deaf,
    disk_full,
    encoder_cut,
    encoder_slips,
    ended,
    hogged,
    joystick_is,
    killed,
    link_delayed,
    reset,
    second,
    second_hand,
    sonar,
    sonar_flickers,
    suspended,
    tilt_sensor,
    unplugged,
    wheel_blocked,
    wheel_held_back,
)

_SERVICES: Final = {"base": ROBOT_SIDE, "guard": ROBOT_SIDE, "joystick": OPERATORS, "ranger": OPERATORS}

_SHORT: Final = 0.3
"""s; the operator's side calls its link lost after 0.5 s without a tick, and that takes a level hand."""

_PROCESSES: Final = (
    *(Scenario(faults=(killed(name),), bound=bound) for name, bound in _SERVICES.items()),
    *(Scenario(faults=(ended(name),), bound=bound) for name, bound in _SERVICES.items()),
    *(Scenario(faults=(suspended(name),), bound=bound, lasts=3.0) for name, bound in _SERVICES.items()),
    *(Scenario(faults=(suspended(name),), bound=bound, lasts=8.0) for name, bound in _SERVICES.items()),
    *(Scenario(faults=(suspended(name),), does="dips", lasts=0.1) for name in _SERVICES),
    *(Scenario(faults=(suspended(name),), does="dips", lasts=_SHORT) for name in _SERVICES),
    Scenario(faults=(killed("guard"),), bound=ROBOT_SIDE, tilt=BACKWARD),
    Scenario(faults=(killed("ranger"),), bound=OPERATORS, tilt=BACKWARD),
    Scenario(faults=(killed("base"),), bound=ROBOT_SIDE, tilt=LEFT),
    Scenario(faults=(killed("guard"),), bound=ROBOT_SIDE, tilt=LEFT),
    Scenario(faults=(killed("joystick"),), bound=OPERATORS, tilt=LEFT),
    Scenario(faults=(killed("odometry"),), does="drives on"),
    Scenario(faults=(suspended("odometry"),), does="drives on", lasts=3.0),
)

_LINK: Final = (
    Scenario(faults=(LINK_CUT,), does="dips", lasts=0.1),
    Scenario(faults=(LINK_CUT,), does="dips", lasts=_SHORT),
    Scenario(faults=(LINK_CUT,), bound=OPERATORS, lasts=1.4),
    Scenario(faults=(LINK_CUT,), bound=OPERATORS, lasts=3.0),
    Scenario(faults=(LINK_CUT,), bound=OPERATORS, lasts=8.0),
    Scenario(faults=(LINK_CUT,), bound=OPERATORS, lasts=20.0),
    Scenario(faults=(LINK_CUT,), bound=OPERATORS, lasts=3.0, tilt=LEFT),
    Scenario(faults=(LINK_SEVERED,), does="dips", lasts=0.2),
    Scenario(faults=(link_delayed(0.1),), does="drives on", lasts=3.0),
    Scenario(faults=(link_delayed(0.5),), bound=OPERATORS, lasts=3.0),
)

_BOARDS: Final = (
    Scenario(faults=(unplugged("base"),), bound=ROBOT_SIDE),
    Scenario(faults=(unplugged("joystick"),), bound=OPERATORS),
    Scenario(faults=(unplugged("ranger"),), bound=OPERATORS),
    Scenario(faults=(unplugged("base"),), bound=ROBOT_SIDE, lasts=0.2),
    Scenario(faults=(unplugged("joystick"),), bound=OPERATORS, lasts=5.0),
    Scenario(faults=(unplugged("ranger"),), bound=OPERATORS, lasts=5.0),
    Scenario(faults=(reset("base"),), bound=ROBOT_SIDE),
    Scenario(faults=(reset("base", "watchdog"),), bound=ROBOT_SIDE),
    Scenario(faults=(reset("base", "brown_out"),), bound=ROBOT_SIDE),
    Scenario(faults=(reset("joystick"),), bound=OPERATORS),
    Scenario(faults=(reset("ranger"),), does="dips"),
)

_LAID_DOWN: Final = 1.0 + OPERATORS
_CUTOFF: Final = 5.0 + 0.5
"""s: held for 5 s, of a voltage that is read twice a second."""
_JOINS: Final = 1.0
"""s from joining the network to being heard, and to the stop."""
_FROZEN: Final = 1.5
_WILD: Final = 4.0
"""s: 16 readings of a sensor that is pinged 5.6 times a second, after each of which that way is blocked anyway."""

_FADED: Final = 5.0
"""s: 1.2 m of way at full speed, while a sensor that hears nothing is trusted, and 0.8 m while that fades, take 4 s."""
_PARKED: Final = 21.0
"""s: longer than any trust lasts."""
_NEAR: Final = 2.8
"""s after which a robot that has driven for 1.2 s is 1.6 m before the arena's wall."""
_HELD: Final = 3.5
"""s from there to the margin before that wall: it stands on, however deaf the sensors are."""
_TURNED: Final = ((BACKWARD, 1.0), (LEFT, 1.0), (RIGHT, 1.0))
"""s: what the guard advises where a way is shut. Trust fades by turning, too."""
_TURNED_BACK: Final = 3.5

_FRONT: Final = ((0, FORWARD), (1, FORWARD))
_ALL: Final = (*_FRONT, (2, BACKWARD))

_BUMPER: Final = {"GIRAFF_ROBOT_SENSORS__BUMPER": '{ type = "bumper", index = 0, way = "forward" }'}

_SENSORS: Final = (
    *(
        Scenario(faults=(sonar(number, fault),), bound=OPERATORS, rearms=False, tilt=tilt)
        for number, tilt in _ALL
        for fault in (SonarFault.DEAD, SonarFault.STUCK)
    ),
    *(
        Scenario(faults=(sonar(number, SonarFault.FROZEN),), bound=_FROZEN, lasts=2.5, rearms=False, tilt=tilt)
        for number, tilt in _ALL
    ),
    *(
        Scenario(faults=(sonar(number, SonarFault.WILD),), does="creeps", bound=_WILD, lasts=6.0, tilt=tilt)
        for number, tilt in _ALL
    ),
    *(
        Scenario(faults=(deaf(*numbers),), does="slows", bound=_FADED, lasts=7.0, tilt=tilt)
        for numbers, tilt in (((0,), FORWARD), ((1,), FORWARD), ((0, 1), FORWARD), ((2,), BACKWARD))
    ),
    Scenario(
        faults=(deaf(0, 1, told="beside another robot", fault=SonarFault.OVERHEARS),),
        does="slows",
        bound=_FADED,
        lasts=7.0,
    ),
    Scenario(
        faults=(deaf(0, 1, after=_NEAR, told="1.6 m before a wall"),),
        does="slows",
        bound=_HELD,
        lasts=5.0,
    ),
    Scenario(
        faults=(deaf(0, 1, after=_NEAR, then=_TURNED, told="backed up and turned to and fro"),),
        does="slows",
        bound=_TURNED_BACK,
        lasts=5.5,
    ),
    *(
        Scenario(
            faults=(deaf(*numbers, then=((LEVEL, _PARKED),), on=tilt, told=f"parked for {_PARKED:g} s"),),
            does="slows",
            bound=0.1,
            lasts=4.0,
            tilt=tilt,
        )
        for numbers, tilt in (((0, 1), FORWARD), ((2,), BACKWARD))
    ),
    Scenario(faults=(bumper_cut("front", 0),), bound=OPERATORS, rearms=False, parts=_BUMPER),
    Scenario(faults=(sonar_flickers(0, 2.5),), bound=OPERATORS, lasts=2.5, rearms=False),
    *(
        Scenario(faults=(tilt_sensor(fault),), bound=OPERATORS)
        for fault in (Bno055Fault.DEAD, Bno055Fault.ZERO, Bno055Fault.FROZEN, Bno055Fault.SYSTEM_ERROR)
    ),
    *(
        Scenario(faults=(tilt_sensor(fault), reset("joystick")), bound=OPERATORS, lasts=3.0)
        for fault in (Bno055Fault.WRONG_CHIP, Bno055Fault.SELF_TEST)
    ),
    Scenario(faults=(joystick_is("dropped"),), bound=OPERATORS),
    Scenario(faults=(joystick_is("shaken"),), bound=OPERATORS),
    Scenario(faults=(joystick_is("laid_down"),), bound=_LAID_DOWN, lasts=2.5),
)

_DOUBTED: Final = 1.0
"""s: 0.35 s of driving from 0.18 m/s on, and slowing down."""
_MOTORS: Final = (
    *(Scenario(faults=(encoder_cut(wheel),), bound=ROBOT_SIDE) for wheel in ("left", "right")),
    Scenario(faults=(encoder_slips("left"),), does="slows", bound=_DOUBTED, lasts=5.0),
    *(Scenario(faults=(wheel_blocked(wheel),), bound=ROBOT_SIDE) for wheel in ("left", "right")),
    *(Scenario(faults=(wheel_held_back(wheel),), bound=ROBOT_SIDE) for wheel in ("left", "right")),
    Scenario(faults=(encoder_cut("left"),), bound=ROBOT_SIDE, tilt=LEFT),
    Scenario(faults=(ENCODERS_FLICKER,), does="drives on"),
    Scenario(faults=(wheel_blocked("right"),), bound=ROBOT_SIDE, tilt=BACKWARD),
    Scenario(faults=(battery(18.0),), bound=_CUTOFF, lasts=7.0, tilt=LEFT),
)

_HOST: Final = (
    Scenario(faults=(ESTOP_ENGAGED,), bound=ROBOT_SIDE),
    Scenario(faults=(ESTOP_ENGAGED,), bound=ROBOT_SIDE, tilt=LEFT),
    Scenario(faults=(ESTOP_ENGAGED, killed("base")), bound=ROBOT_SIDE),
    Scenario(faults=(ESTOP_ENGAGED, reset("base", "power_on")), bound=ROBOT_SIDE),
    Scenario(faults=(disk_full("base"),), does="drives on"),
    Scenario(faults=(disk_full("base"), ESTOP_ENGAGED), bound=ROBOT_SIDE),
    Scenario(faults=(disk_full("guard"),), does="drives on"),
    Scenario(faults=(hogged(4),), does="dips", lasts=3.0, loads=True),
    Scenario(faults=(hogged(4), killed("guard")), bound=TWO_AT_ONCE, loads=True),
    Scenario(faults=(second("guard"),), bound=_JOINS, lasts=2.0),
    Scenario(faults=(second("base", GIRAFF_BASE_PORT="nowhere"),), bound=_JOINS, lasts=2.0),
    Scenario(faults=(second("ranger", GIRAFF_RANGER_PORT="nowhere"),), does="drives on", lasts=2.0),
    Scenario(faults=(second_hand(),), does="drives on", lasts=2.0),
)

_TWO: Final = (
    Scenario(faults=(killed("joystick"), killed("ranger")), bound=TWO_AT_ONCE),
    Scenario(faults=(killed("guard"), killed("base")), bound=TWO_AT_ONCE),
    Scenario(faults=(suspended("guard"), unplugged("joystick")), bound=TWO_AT_ONCE),
    Scenario(faults=(LINK_CUT, unplugged("base")), bound=TWO_AT_ONCE, lasts=3.0),
    Scenario(faults=(LINK_CUT, suspended("ranger")), bound=TWO_AT_ONCE, lasts=3.0),
    Scenario(faults=(reset("base"), killed("guard")), bound=TWO_AT_ONCE),
)

_CHAIN: Final = {
    "base": ROBOT_SIDE,
    "guard": ROBOT_SIDE,
    "ranger": OPERATORS,
    "motion": OPERATORS,
    "odometry": OPERATORS,
}
"""All that a motion needs of the robot."""

_MOVING: Final = (
    Scenario(faults=(REQUESTER_KILLED,), bound=OPERATORS, by="motion"),
    Scenario(faults=(suspended("requester"),), bound=OPERATORS, by="motion"),
    Scenario(faults=(LINK_CUT,), bound=OPERATORS, by="motion"),
    Scenario(faults=(link_delayed(0.5),), bound=OPERATORS, lasts=3.0, by="motion"),
    *(Scenario(faults=(killed(name),), bound=bound, by="motion") for name, bound in _CHAIN.items()),
    Scenario(faults=(ended("motion"),), bound=OPERATORS, by="motion"),
    *(Scenario(faults=(suspended(name),), bound=OPERATORS, by="motion") for name in ("motion", "odometry")),
    Scenario(faults=(ESTOP_ENGAGED,), bound=ROBOT_SIDE, by="motion"),
)

SCENARIOS: Final = (*_PROCESSES, *_LINK, *_BOARDS, *_SENSORS, *_MOTORS, *_HOST, *_TWO, *_MOVING)
