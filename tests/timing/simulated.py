"""Which rows of the fault table are judged in simulated time, too, in `make test`."""

from typing import Final

from tests.timing.faults import MOVING, Scenario

STOPS: Final = "tests/dst/test_stops.py::test_a_fault_stops_the_robot_within_its_bound"
MOTION_STOPS: Final = "tests/loop/test_motion_stops.py::test_a_fault_stops_a_motion_within_its_bound"
_ESTOP: Final = "tests/loop/test_motion_ends.py::test_an_emergency_stop_ends_it_and_a_reset_moves_nothing"
_KILLS: Final = "tests/loop/test_kills.py::test_pwm_is_zero_within_the_bound"
_MISHAPS: Final = "tests/loop/test_mishaps.py::test_a_mishap_stops_the_robot_within_its_bound"
_RESTARTED: Final = "tests/dst/test_doubles.py::test_a_restarted_board"
_SECOND: Final = "tests/dst/test_doubles.py::test_a_second_process"
_DEAF: Final = "tests/loop/test_deaf.py::test_what_a_deaf_sensor_has_heard_or_would_have_is_touched_slowly"
_FLICKER: Final = "tests/loop/test_flicker.py::test_a_motion_arrives_although_both_encoders_flicker_at_rest"

_BY_STOPS: Final = (
    *(f"{service} {does}" for service in ("base", "guard", "joystick", "ranger") for does in ("ended", "suspended")),
    *(f"sonar {number} {fault}" for number in range(3) for fault in ("dead", "stuck", "frozen")),
    "link cut",
    "link delayed by 0.5 s",
    "joystick board unplugged",
    "base board reset (external)",
    "joystick board reset (external)",
    "tilt sensor zero",
    "tilt sensor system_error",
    "tilt sensor wrong_chip + joystick board reset (external)",
    "tilt sensor self_test + joystick board reset (external)",
    "left encoder cut",
    "right encoder cut",
    "left wheel blocked",
    "right wheel blocked",
    "left wheel held back",
    "right wheel held back",
    "battery at 18 V",
    "e-stop engaged",
    "e-stop engaged + base killed",
    "e-stop engaged + base board reset (power_on)",
    "joystick killed + ranger killed",
    "guard killed + base killed",
    "guard suspended + joystick board unplugged",
    "link cut + base board unplugged",
    "link cut + ranger suspended",
    "base board reset (external) + guard killed",
)

_BY_MOTION_STOPS: Final = (
    *(f"{service} killed" for service in ("requester", "motion", "odometry", "base", "guard", "ranger")),
    *(f"{service} suspended" for service in ("requester", "motion", "odometry")),
    "motion ended",
    "link cut",
    "link delayed by 0.5 s",
)

SIMULATED: Final = {
    **{f"{service} killed": f"{_KILLS}[{service}]" for service in ("base", "guard", "joystick", "ranger")},
    **{name: f"{STOPS}[{name}]" for name in _BY_STOPS},
    **{f"{name}{MOVING}": f"{MOTION_STOPS}[{name}]" for name in _BY_MOTION_STOPS},
    f"e-stop engaged{MOVING}": _ESTOP,
    "left encoder loses half of its counts": (
        "tests/loop/test_slip.py::test_a_slipping_encoder_hardly_turns_the_robot"
    ),
    "odometry killed": "tests/loop/test_kills.py::test_without_odometry_driving_goes_on",
    "base board unplugged": "tests/dst/test_doubles.py::test_a_replugged_board",
    "ranger board unplugged": "tests/dst/test_doubles.py::test_a_ranger_that_was_missed_for_over_a_second",
    "base board reset (watchdog)": _RESTARTED,
    "base board reset (brown_out)": _RESTARTED,
    "second base": _SECOND,
    "second guard": _SECOND,
    "tilt sensor dead": f"{_MISHAPS}[dead]",
    "tilt sensor frozen": f"{_MISHAPS}[frozen]",
    "joystick dropped": f"{_MISHAPS}[dropped]",
    "joystick shaken": f"{_MISHAPS}[shaken]",
    "joystick laid down": f"{_MISHAPS}[laid down]",
    "both encoders on the edge of a count at rest": _FLICKER,
    "front bumper's wire cut": "tests/loop/test_bumper.py::test_a_cut_wire_stops_its_way_and_no_other",
    "sonar 0 deaf": f"{_DEAF}[132]",
    "sonar 2 deaf": f"{_DEAF}[338]",
    "sonar 0 and 1 deaf": f"{_DEAF}[17]",
    "sonar 0 and 1 deaf, beside another robot": (
        "tests/loop/test_overheard.py::test_a_deaf_robot_beside_another_one_touches_slowly"
    ),
    "sonar 0 and 1 deaf, 1.6 m before a wall": f"{_DEAF}[17]",
    "sonar 0 and 1 deaf, backed up and turned to and fro": f"{_DEAF}[43]",
}
"""Node ids, by the names of the faults, of what they do for good: no row in which the robot goes on by itself."""


def judge_of(scenario: Scenario) -> str:
    """Who judges the same in simulated time; '' if nobody does."""
    return "" if scenario.does == "dips" else SIMULATED.get(scenario.fault, "")
