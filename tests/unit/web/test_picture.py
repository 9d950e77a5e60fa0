"""What pages are shown: the newest, and nothing that says nothing of now."""

import msgspec
import pytest

from giraff_core.estop.request import BY_WORD
from giraff_schemas.bumper import Bump
from giraff_schemas.localization import MapPose, PlanarPose
from giraff_schemas.messages import Battery, EStop, Lease, Odometry, Range, RobotTime, Tick
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_web.config import WebConfig
from giraff_web.messages import State, ToPage
from giraff_web.picture import Picture
from giraff_web.policy import WebPolicy
from tests.support.robots import BUMPED, ROBOT
from tests.unit.cli.samples import attitude, base, guard, verdict

TICK = RobotTime(epoch=7, robot_ns=1 << 62)


class Shown:
    """A picture, and the policy whose driver it tells."""

    def __init__(self, *, is_open: bool = False) -> None:
        self.picture = Picture(BUMPED, is_open=is_open)
        self.policy = WebPolicy(WebConfig(), ROBOT, "me")
        self.policy.operator.on_tick(Tick(instance="base", epoch=7, robot_ns=1 << 62), 0.0)

    def at(self, now: float) -> State:
        state = self.picture.state(self.policy, NO_TROUBLE, now)
        decoded = msgspec.json.decode(msgspec.json.encode(state), type=ToPage)
        assert isinstance(decoded, State)
        return decoded


def odometry(x: float, **fields: int) -> Odometry:
    return Odometry(
        instance="odometry",
        x=x,
        y=0.0,
        yaw=0.0,
        linear_x=0.2,
        angular_z=0.0,
        covariance=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        path=x,
        board_us=0,
        boot_id=1,
        tick=TICK,
        **fields,
    )


@pytest.fixture
def shown() -> Shown:
    return Shown()


def test_what_is_not_heard_is_not_shown() -> None:
    state = Shown().at(0.1)
    assert (state.armed, state.stop, state.directions, state.pose, state.battery) == (None,) * 5
    assert set(state.evidence) == set(BUMPED.sensors)
    assert {view.state for view in state.evidence.values()} == {"fault"}
    assert {str(view.reason) for view in state.evidence.values()} == {"never heard; check that giraff_ranger runs"}
    assert "guard" in state.why.what


def test_each_sensor_is_shown_by_its_own_evidence(shown: Shown) -> None:
    heard = Range(sensor="rear", state="echo", range=0.8, echo_us=1, tick=TICK)
    clear = msgspec.structs.replace(heard, sensor="front_left", state="clear", range=None)
    fault = msgspec.structs.replace(clear, sensor="front_right", state="fault", reason=Trouble("no echo line"))
    pushed = Bump(sensor="front", pressed=True, tick=TICK)
    free = Bump(sensor="back", pressed=False, tick=TICK)
    strangers = (msgspec.structs.replace(heard, sensor="stranger"), msgspec.structs.replace(heard, sensor="front"))
    for sample in (heard, clear, fault, pushed, free, *strangers):
        shown.picture.on_sample(sample, 0.0)
    views = shown.at(0.1).evidence
    assert {name: (view.state, view.text, view.reason.what) for name, view in views.items()} == {
        "front_left": ("free", "clear", ""),
        "front_right": ("fault", "fault", "no echo line"),
        "rear": ("seen", "0.80 m", ""),
        "front": ("near", "pushed", ""),
        "back": ("free", "free", ""),
    }
    [edge] = views["rear"].seen
    assert edge[1] == (-1.05, 0.0)
    assert views["rear"].free == (((-0.25, 0.0), *edge, (-0.25, 0.0)),)
    for field, seen in (("front_left", 0), ("front_right", 0), ("back", 0), ("front", 1)):
        view = views[field]
        assert (len(view.free), len(view.seen)) == (1 - seen, seen)
    assert len(msgspec.json.encode(views)) < 1500, "25 of them go to each page a second"


def test_how_a_robot_balances_is_shown_with_its_wheels_and_of_no_other_robot(shown: Shown) -> None:
    shown.picture.on_sample(odometry(1.0), 0.0)
    assert shown.at(0.1).balance is None
    shown.picture.on_sample(attitude(0), 0.0)
    balance = shown.at(0.1).balance
    assert balance is not None
    assert (balance.posture, balance.lean, balance.wheels) == ("stands", 0.02618, (0.2, 0.2))
    assert shown.at(1.6).balance is None


def test_a_tick_goes_down_exactly_and_none_of_a_robot_that_is_lost(shown: Shown) -> None:
    assert shown.at(0.1).tick == ("7", str(1 << 62))
    assert shown.at(1.0).tick is None


def test_all_that_is_heard_is_shown_as_long_as_it_is_new(shown: Shown) -> None:
    latch = EStop(instance="base", engaged=False, id=1, by="x")
    here = PlanarPose(x=0.0, y=0.0, yaw=0.0)
    place = MapPose(
        state="lost", x=1.0, y=2.0, yaw=0.5, covariance=(0.04, 0.01, 0.0, 0.09, 0.0, 0.01), odom=here, candidates=(),
        explained=0.2, way=3.0, particles=9, map="flat", reason=Trouble("nothing fits", "drive on"), tick=TICK,
    )  # fmt: skip
    for sample in (base(), guard(verdict()), latch, Battery(voltage=24.0), odometry(1.0), place):
        shown.picture.on_sample(sample, 0.0)
    state = shown.at(0.1)
    assert None not in (state.armed, state.stop, state.directions, state.pose, state.battery, state.speed, state.map)
    assert state.map is not None
    assert (state.map.covariance, state.map.yaw_sd, state.map.odom) == ((0.04, 0.01, 0.09), 0.1, (0.0, 0.0, 0.0))
    old = shown.at(2.0)
    assert (old.armed, old.stop, old.directions, old.pose, old.battery, old.map) == (None,) * 6


def test_a_sensor_that_is_silent_is_told_so(shown: Shown) -> None:
    shown.picture.on_sample(Bump(sensor="front", pressed=True, tick=TICK), 0.0)
    assert shown.at(0.9).evidence["front"].text == "pushed"
    silent = shown.at(1.6).evidence["front"]
    assert (silent.state, str(silent.reason)) == ("fault", "silent for 2 s; check that giraff_ranger runs")
    assert (silent.free, silent.seen) == (shown.at(0.9).evidence["front"].seen, ())


def test_the_path_is_bounded_and_begins_anew_where_a_pose_was_set(shown: Shown) -> None:
    for step in range(3000):
        shown.picture.on_sample(odometry(step * 0.04), 0.0)
        shown.picture.on_sample(odometry(step * 0.04 + 0.01), 0.0)
    assert len(shown.picture.trail) == 2000
    assert shown.picture.trail[-1][0] == pytest.approx(2999 * 0.04)
    shown.picture.on_sample(odometry(0.0, jumps=1), 0.0)
    assert shown.picture.trail == ((0.0, 0.0),)


def test_the_room_fits_until_odometry_begins_anew_or_its_pose_is_set() -> None:
    for later in (odometry(0.0, jumps=1), msgspec.structs.replace(odometry(0.0), instance="another")):
        shown, late = Shown(), Shown()
        for sample in (odometry(1.0), later):
            shown.picture.on_sample(sample, 0.0)
        late.picture.on_sample(later, 0.0)
        assert (shown.at(0.1).room_fits, late.at(0.1).room_fits) == (False, later.jumps == 0)


def test_numbers_that_a_page_cannot_hold_are_texts(shown: Shown) -> None:
    why = Trouble("y", "free it", "release")
    latch = EStop(instance="base", engaged=True, id=(1 << 53) - 1, by="x", reason=why, engaged_ns=1 << 62)
    shown.picture.on_sample(latch, 0.0)
    state = shown.at(0.1)
    assert state.stop is not None
    assert (state.stop.id, state.stop.engaged_ns) == (str((1 << 53) - 1), str(1 << 62))
    assert state.stop.reason == why


@pytest.mark.parametrize(("is_open", "word"), [(False, "confirmed"), (True, BY_WORD)])
def test_whose_word_a_stop_is_stands_beside_it(is_open: bool, word: str) -> None:
    shown = Shown(is_open=is_open)
    shown.picture.on_sample(EStop(instance="base", engaged=True, id=1, by="x", reason=Trouble("y")), 0.0)
    state = shown.at(0.1)
    assert state.stop is not None
    assert state.stop.word == word


def test_who_drives_is_named(shown: Shown) -> None:
    held = Trouble("held by joystick (x)", "wait", "ask", "joystick")
    shown.policy.operator.on_lease(Lease(instance="g", holder="x", operator="joystick", counter=1, reason=held))
    state = shown.at(0.1)
    assert (state.operator, state.device, state.page) == ("joystick", "", 0)
    assert state.why == held
