"""Twenty drawn robots that balance, each in every situation. Lengths in m, speeds in m/s, angles in degrees."""

from collections.abc import Mapping
from functools import partial
from typing import Final

import pytest

from tests.loop.balancer import between_walls, breaks_on_tour, tour
from tests.support.balancing import (
    Figures,
    Row,
    among_people,
    battery_falls,
    broken,
    carried,
    cord_pulled,
    encoders_cut,
    gyro_stuck_at_middle,
    held,
    known_zero,
    leaned_on,
    lifted,
    line_cut,
    onto_slope,
    over_threshold,
    prototype_pushed,
    prototype_stands,
    pushes,
    sensor_at,
    sensor_frozen,
    sits,
    stands,
    starts,
    stopped,
    wheel_stuck,
    with_bag,
)
from tests.support.report import report

ROBOTS: Final = 20
DRIVEN: Final = 10
"""Robots that are driven with all services."""
UP: Final = {"up": 1.0}
RUN_ON: Final = 0.12
"""m. `[guard] run_on` of the robot's file."""
ROWS: Final = {
    "stands": Row(
        lambda seed: stands(seed, 60.0, settle=20.0),
        {"sd": 1.1, "span": 0.08, "late": 0.0},
        {"sd": (0.6, 1)},
        at_least=UP,
    ),
    "let_go": Row(lambda seed: stands(seed, 12.0, settle=0.0), {"way": 0.22}, at_least=UP),
    "let_go_zero_known": Row(
        lambda seed: stands(seed, 12.0, settle=0.0, **known_zero(seed)), {"way": 0.05}, at_least=UP
    ),
    "pushed_5": Row(pushes(5.0), {"lean": 6.5, "away": 0.32, "back": 0.10, "back_speed": 0.14}, at_least=UP),
    "pushed_8": Row(pushes(8.0), {"away": 0.62, "back": 0.10, "back_speed": 0.15}, at_least=UP),
    "leaned_on_and_let_go": Row(leaned_on, {"back": 0.25, "back_speed": 0.23}, at_least=UP),
    "held": Row(held(0.0), {"touch": 6.0, "held": 0.0}, at_least=UP),
    "held_and_asked": Row(held(0.3), {"touch": 30.0, "noticed": 3.5}, at_least=UP),
    **{
        f"{'silent' if by_silence else 'stopped'}_at_{speed}": Row(
            stopped(speed, by_silence=by_silence),
            {"away": path, "back": 0.09, "back_speed": 0.11, "run_on": RUN_ON},
            at_least=UP,
        )
        for by_silence in (False, True)
        for speed, path in ((0.1, 0.14), (0.2, 0.19), (0.3, 0.26), (0.4, 0.36))
    },
    **{
        f"stopped_after_{after}_s": Row(
            stopped(0.4, by_silence=False, after=after), {"run_on": RUN_ON, "back": 0.09}, at_least=UP
        )
        for after in (0.4, 0.8, 1.2, 1.6)
    },
    **{
        f"asked_for_nothing_at_{speed}": Row(
            stopped(speed, by_zero=True), {"back": 0.09, "run_on": RUN_ON}, at_least=UP
        )
        for speed in (0.1, 0.2, 0.3, 0.4)
    },
    **{
        f"asked_for_nothing_after_{after}_s": Row(
            stopped(0.4, by_zero=True, after=after), {"back": 0.09, "run_on": RUN_ON}, at_least=UP
        )
        for after in (0.4, 0.8, 1.2, 1.6)
    },
    **{
        f"starts_to_{speed}": Row(starts(speed), {"over": 0.10, "back": 0.035}, at_least=UP)
        for speed in (0.1, 0.2, 0.3, 0.4)
    },
    "sits": Row(sits, {"off": 0.7, "span": 0.10, "top": 1.2}, at_least={"right_side": 1.0}),
    "sits_from_0.3": Row(
        partial(sits, speed=0.3), {"off": 1.7, "span": 0.25, "top": 1.2}, at_least={"right_side": 1.0}
    ),
    "slope_3": Row(onto_slope, {"way": 0.7, "last_speed": 0.03}, at_least=UP),
    "bag_6": Row(with_bag, {"way": 1.3}, at_least=UP),
    "threshold_5_mm": Row(over_threshold, {}, at_least=UP | {"gone": 0.35}),
    "prototype_stands": Row(prototype_stands, {}, at_least=UP),
    "prototype_pushed": Row(prototype_pushed, {}, at_least=UP | {"gone": 0.25}),
}
"""Bounds that a simulation with compiled physics had shown before. Here the sensors' noise is larger, and one robot of
160 that stop rolls back at 0.115 m/s, where that one had 0.11 at most."""
FAULTS: Final = {
    "gyro_rail": Row(broken(sensor_at(0.0, 0), moves=False), {"off": 0.02}),
    "gyro_rail_moving": Row(broken(sensor_at(0.0, 0), moves=True), {"off": 0.02}),
    "gyro_frozen": Row(broken(sensor_frozen(0), moves=False), {"off": 0.10}),
    "gyro_frozen_moving": Row(broken(sensor_frozen(0), moves=True), {"off": 0.10}),
    "gyro_stuck": Row(broken(gyro_stuck_at_middle, moves=False), {"off": 3.5}),
    "gyro_stuck_moving": Row(broken(gyro_stuck_at_middle, moves=True), {"off": 1.1}),
    "accelerometer_rail": Row(broken(sensor_at(0.0, 2, 3), moves=False), {"noticed": 0.02, "off": 1.1, "span": 0.35}),
    "accelerometer_rail_moving": Row(
        broken(sensor_at(0.0, 2, 3), moves=True), {"noticed": 0.02, "off": 3.0, "span": 0.40}
    ),
    "accelerometer_frozen": Row(broken(sensor_frozen(2, 3), moves=False), {"noticed": 0.1, "off": 1.1, "span": 0.35}),
    "accelerometer_frozen_moving": Row(
        broken(sensor_frozen(2, 3), moves=True), {"noticed": 0.1, "off": 3.0, "span": 0.35}
    ),
    # One of the twenty drives a curve about that wheel, which hardly turns: it does as it is asked, and shows nothing.
    "encoder_moving": Row(
        broken(encoders_cut(0), moves=True), {}, {"noticed": (2.0, 3), "off": (3.4, 2), "span": (0.46, 1)}
    ),
    "both_encoders_moving": Row(broken(encoders_cut(0, 1), moves=True), {"span": 0.20}, {"off": (1.8, 3)}),
    "line_moving": Row(broken(line_cut, moves=True), {"span": 0.20}, {"noticed": (0.7, 3)}),
    "encoder": Row(broken(encoders_cut(0), moves=False, seconds=8.0), {"span": 0.45}, {"noticed": (3.0, 0)}),
    "both_encoders": Row(broken(encoders_cut(0, 1), moves=False, seconds=8.0), {"span": 0.45}, {"noticed": (3.0, 0)}),
    "line": Row(broken(line_cut, moves=False, seconds=8.0), {"span": 0.45}, {"noticed": (6.0, 0)}),
    "wheel_stuck_moving": Row(broken(wheel_stuck, moves=True), {"span": 1.0}, {"noticed": (2.1, 9)}),
    "lifted": Row(broken(lifted, moves=False), {}, {"off": (0.7, 2)}),
    "lifted_moving": Row(broken(lifted, moves=True), {}, {"off": (1.5, 8)}),
    "carried": Row(broken(carried, moves=False), {"off": 2.1}),
    "carried_moving": Row(broken(carried, moves=True), {"off": 2.1}),
    "battery": Row(broken(battery_falls, moves=False), {"noticed": 0.25, "off": 1.05, "span": 0.10}),
    "battery_moving": Row(broken(battery_falls, moves=True), {"noticed": 0.28, "off": 3.25}),
    "cord": Row(broken(cord_pulled, moves=False), {"off": 0.006, "span": 0.10}),
    "cord_moving": Row(broken(cord_pulled, moves=True, speed=0.4), {"off": 0.006, "span": 0.25}),
}
PEOPLE: Final = Row(among_people, {}, {"held": (0.0, 1)}, at_least=UP)


ON_TOUR: Final = {
    "gyro_rail": sensor_at(0.0, 0),
    "accelerometer_frozen": sensor_frozen(2, 3),
    "encoder": encoders_cut(0),
    "both_encoders": encoders_cut(0, 1),
    "line": line_cut,
    "wheel_stuck": wheel_stuck,
    "lifted": lifted,
    "cord": cord_pulled,
}
"""What fails while it is driven round the furnished room. A fallen robot lies within its footprint."""


def exceeded(row: Row, robots: list[Figures]) -> dict[str, list[float]]:
    """Return the values of each figure that breaks its bound, the worst first."""
    most = [(figure, bound, 0) for figure, bound in row.at_most.items()]
    most += [(figure, bound, others) for figure, (bound, others) in row.mostly.items()]
    found = {}
    for figure, bound, others in most:
        over = sorted((robot[figure] for robot in robots if robot[figure] > bound), reverse=True)
        if len(over) > others:
            found[figure] = over
    for figure, least in row.at_least.items():
        if under := sorted(robot[figure] for robot in robots if robot[figure] < least):
            found[figure] = under
    return found


def told(row: Row, robots: list[Figures]) -> Mapping[str, str]:
    """Return the median, 90 % and worst value of each judged figure."""
    shown = {}
    for figure in {**row.at_most, **row.mostly, **row.at_least}:
        values = sorted((robot[figure] for robot in robots), reverse=figure in row.at_least)
        shown[figure] = "/".join(f"{values[int(share * (len(values) - 1))]:.3g}" for share in (0.5, 0.9, 1.0))
    return shown


@pytest.mark.parametrize("name", ROWS | FAULTS)
def test_drawn_robots_stay_within_the_bounds(name: str) -> None:
    row = (ROWS | FAULTS)[name]
    robots = [row.play(seed) for seed in range(ROBOTS)]
    report(f"campaign/balancer_{name}", told(row, robots))
    assert exceeded(row, robots) == {}


def test_ten_minutes_among_people_show_no_fault() -> None:
    robots = [among_people(seed) for seed in range(5)]
    report("campaign/balancer_people", told(PEOPLE, robots))
    assert exceeded(PEOPLE, robots) == {}


@pytest.mark.parametrize("seed", range(DRIVEN))
def test_a_drawn_robot_drives_round_the_furnished_room(seed: int) -> None:
    drive = tour(seed)
    report(f"campaign/balancer_tour_{seed}", drive._asdict())
    assert (drive.contacts, drive.falls) == (0, 0)
    assert drive.path > 5.0
    assert drive.fastest < 0.45


def test_drawn_robots_stop_before_a_wall_and_turn_in_place() -> None:
    drives = [between_walls(seed) for seed in range(DRIVEN)]
    figures = {"closest": min(each.drive.closest for each in drives), "astray": max(each.astray for each in drives)}
    report("campaign/balancer_walls", figures)
    assert [(each.drive.contacts, each.drive.falls) for each in drives] == [(0, 0)] * DRIVEN
    assert figures["closest"] > 0.20
    assert figures["astray"] < 0.10
    assert min(each.turned for each in drives) > 3.0


@pytest.mark.parametrize("name", ON_TOUR)
def test_a_fault_on_a_tour_touches_nothing_and_ends_it(name: str) -> None:
    drives = [breaks_on_tour(seed, ON_TOUR[name]) for seed in range(DRIVEN)]
    figures = {"gone": max(each.gone for each in drives), "drive_on": sum(each.drives for each in drives)}
    report(f"campaign/balancer_on_tour_{name}", figures)
    assert [each.contacts for each in drives] == [0] * DRIVEN
    assert figures["gone"] < 1.0
    assert figures["drive_on"] == 0
