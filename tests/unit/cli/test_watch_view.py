"""What a person or a script sees of a live robot."""

import io
import re
from dataclasses import replace
from typing import Any

import msgspec
from rich.console import Console

from giraff_cli.watch.screen import ReportView, WatchView, missing
from giraff_core.kinematics.pose import Pose
from giraff_schemas import topics
from giraff_schemas.messages import Battery, Wheels
from giraff_schemas.places import NO_ROUTE
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_telemetry.collector import Telemetry
from giraff_telemetry.describe import limit_text, moving, route_text
from tests.support.motion_double import BLOCKED, route_state
from tests.unit.cli.map_poses import map_pose
from tests.unit.cli.samples import (
    MS,
    SENSORS,
    Network,
    attitude,
    base,
    bump,
    camera,
    drive_ten_seconds,
    estop,
    guard,
    lease,
    reading,
    verdict,
    wheels,
    with_bumpers,
)

SECOND = 1000 * MS
NOW = 10 * SECOND


def heard() -> Telemetry:
    """What a watch listens to, of a robot that nobody has told the sensors of."""
    telemetry = Telemetry()
    drive_ten_seconds(telemetry)
    for topic in (topics.TICK, topics.TILT, topics.WHEELS, topics.CMD_VEL, topics.OPERATOR_CMD_VEL.at("joystick")):
        telemetry.forget(topic)
    return telemetry


def listening() -> tuple[Telemetry, Network]:
    """That, and how more is said to it."""
    telemetry = heard()
    return telemetry, Network(telemetry)


def view(telemetry: Telemetry, now_ns: int = NOW, **changes: Any) -> WatchView:
    seen = WatchView(robot="giraff", elapsed=12.34, snapshot=telemetry.snapshot(now_ns), waiting="")
    return replace(seen, **changes)


def drawn(seen: WatchView, width: int = 80) -> list[str]:
    console = Console(file=io.StringIO(), width=width, height=24, color_system=None)
    with console.capture() as capture:
        console.print(seen.render())
    return capture.get().splitlines()


def report(telemetry: Telemetry, now_ns: int = NOW, **changes: Any) -> dict[str, Any]:
    plain = view(telemetry, now_ns, **changes)
    told = ReportView(robot=plain.robot, elapsed=plain.elapsed, snapshot=plain.snapshot, waiting=plain.waiting)
    decoded: dict[str, Any] = msgspec.json.decode(told.line())
    return decoded


def test_the_view_tells_all_of_it_on_80_by_24() -> None:
    shown = drawn(view(heard(), notices=("giraff/x/tick: not MessagePack",)))
    assert len(shown) <= 24
    assert all(len(row) <= 80 for row in shown)
    text = "\n".join(shown)
    for wanted in (
        r"giraff watch · giraff · 0:12 ─",
        r"● base +● guard +● ranger +● odometry +● joystick",
        r"x +4\.000 m +path +4\.00 m +holder +joystick",
        r"y +0\.000 m +speed +0\.40 m/s",
        r"yaw +0\.0 ° +turn +0\.00 rad/s +command +20 ms old, 100 ms left",
        r"front left +1\.23 m █+·+ +5\.6 +state +driving +24\.3 V",
        r"front right +clear ·+",
        r"rear +fault ·+ +5\.6 +e-stop +released",
        r"forward +0\.30 m/s +slow +1\.23 m ahead; turn away",
        r"turn right +1\.00 rad/s +free",
        r"TOPICS +0 lost +Hz +age s",
        r"odom +100\.0 +0\.00",
        r"WHY  1\.23 m ahead",
        r"giraff/x/tick: not MessagePack",
    ):
        assert re.search(wanted, text), f"{wanted} is not in\n{text}"


def test_the_line_is_one_line_with_all_an_operator_needs() -> None:
    shown = view(heard()).line()
    assert shown == (
        "  12.3 s | path   4.00 m |  0.40 m/s  0.00 rad/s | ranges 1.23 m  clear  fault | forward slow (front_left)"
        " | holder joystick | base driving | 24.3 V | 1.23 m ahead; turn away"
    )


def test_a_robot_that_fell_silent_says_since_when_and_shows_no_speed() -> None:
    gone = view(heard(), 13 * SECOND + 200 * MS)
    assert gone.line() == "  12.3 s | giraff silent since 3 s"
    text = "\n".join(drawn(gone))
    assert "giraff watch · giraff · 0:12 · silent since 3 s ─" in text
    assert re.search(r"path +4\.00 m", text)
    assert re.search(r"speed +- m/s", text)
    assert re.search(r"state +silent", text)
    assert re.search(r"reason +not heard for 3 s", text)
    assert re.search(r"odom +100\.\d +3", text) or re.search(r"odom +- +3", text)


def test_a_pause_of_half_a_second_is_no_silence() -> None:
    assert "silent" not in view(heard(), NOW + 500 * MS).line()


def test_while_odometry_is_silent_the_wheels_tell_the_speed() -> None:
    telemetry = heard()
    later = NOW + 2 * SECOND
    turning = msgspec.structs.replace(wheels(later), left_velocity=0.2, right_velocity=0.3)
    assert isinstance(turning, Wheels)
    Network(telemetry).send(topics.WHEELS, turning, later, maker="n")
    assert moving(telemetry.snapshot(later)) == (4.0, 0.25, None)
    telemetry.forget(topics.WHEELS)
    assert moving(telemetry.snapshot(later)) == (4.0, None, None)
    assert moving(Telemetry().snapshot(later)) == (None, None, None)


def test_what_waits_says_for_what() -> None:
    nobody = view(Telemetry(), waiting="no robot is heard on the network; check that it is on", robot="")
    assert nobody.line() == "  12.3 s | no robot is heard on the network; check that it is on"
    text = "\n".join(drawn(nobody))
    assert "giraff watch · any robot" in text
    assert "check that it is on" in text
    assert "GUARD" not in text


def test_an_emergency_stop_says_by_whom_and_why() -> None:
    telemetry, network = listening()
    network.send(topics.ESTOP, estop(engaged=True), NOW, maker="n")
    network.send(topics.BASE, base(armed=False, reason="emergency stop by ann@desk: smoke"), NOW, maker="n")
    text = "\n".join(drawn(view(telemetry)))
    assert re.search(r"state +EMERGENCY STOP", text)
    assert re.search(r"e-stop +engaged by ann@desk: smoke", text)
    assert "| base EMERGENCY STOP | 24.3 V | emergency stop by ann@desk: smoke" in view(telemetry).line()


def test_why_base_does_not_drive_is_in_the_line() -> None:
    telemetry, network = listening()
    network.send(topics.LEASE, lease("", ""), NOW, maker="n")
    network.send(topics.BASE, base(armed=False, reason="hold the hand level"), NOW, maker="n")
    assert "| holder nobody | base not armed | 24.3 V | hold the hand level" in view(telemetry).line()


def test_services_that_are_gone_or_there_twice_show() -> None:
    telemetry = heard()
    telemetry.on_liveliness("guard", "other", present=True)
    telemetry.on_liveliness("odometry", "m", present=False)
    telemetry.on_liveliness("joystick", "m", present=False)
    row = next(row for row in drawn(view(telemetry)) if row.startswith("SERVICES"))
    assert row.rstrip().split("  ")[1:] == ["● base", "● guard x2", "● ranger", "○ odometry", "○ joystick", "● motion"]
    assert missing(telemetry.snapshot(NOW)) == ["odometry"]
    assert "| 24.3 V | not there: odometry | 1.23 m ahead" in view(telemetry).line()
    assert missing(Telemetry().snapshot(NOW)) == ["base", "guard", "ranger", "odometry"]


def test_sensors_are_learnt_from_the_network() -> None:
    telemetry = Telemetry()
    network = Network(telemetry)
    network.send(topics.RANGE, reading("a_side", 0.5), NOW, name="a_side")
    assert list(telemetry.snapshot(NOW).sensed) == ["a_side"]
    network.send(topics.GUARD, guard(verdict()), NOW)
    sensed = telemetry.snapshot(NOW).sensed
    assert list(sensed) == [*SENSORS, "a_side"]
    assert sensed["rear"].newest is None


def test_a_bumper_has_a_row_beside_the_ranges_on_80_by_24() -> None:
    telemetry, network = listening()
    network.send(topics.GUARD, with_bumpers(verdict()), NOW)
    network.send(topics.BUMPER, bump("front", pressed=True), NOW, name="front")
    network.send(topics.RANGE, reading("back", 1.0), NOW, name="back")  # by whoever: the guard calls it a bumper
    rows = [row.rstrip() for row in drawn(view(telemetry, notices=("n" * 200,)))]
    assert len(rows) <= 24
    assert any(re.match(r"front +pushed █·{11}", row) for row in rows), rows
    assert any(re.match(r"back +silent ·{12}", row) for row in rows), rows
    assert not any(row.startswith("bumper/") for row in rows)
    assert "| ranges 1.23 m  clear  fault pushed silent |" in view(telemetry).line()
    told = report(telemetry)
    assert set(told["ranges"]) == set(SENSORS)
    assert told["sensed"] == {
        "front_left": {"type": "hc-sr04", "text": "1.23 m", "nearest": 1.23, "age": 0.1},
        "front_right": {"type": "hc-sr04", "text": "clear", "nearest": None, "age": 0.1},
        "rear": {"type": "hc-sr04", "text": "fault", "nearest": None, "age": 0.1},
        "front": {"type": "bumper", "text": "pushed", "nearest": 0.0, "age": 0.0},
        "back": {"type": "bumper", "text": "silent", "nearest": None, "age": None},
    }


def test_what_the_network_says_cannot_steer_the_terminal_or_break_a_row() -> None:
    telemetry, network = listening()
    bad = "a\x1b[2J\nb[bold]\u202e\u009b" * 20
    network.send(topics.GUARD, guard(verdict(0.0, "blocked", bad, bad, bad)), NOW, maker="n")
    network.send(topics.BASE, base(armed=False, reason=bad, latch=bad), NOW, maker="n")
    network.send(topics.LEASE, lease("x", bad), NOW, maker="n")
    telemetry.on_sample(topics.RANGE, f"range/{bad}", reading(bad, 1.0), NOW)
    telemetry.on_liveliness(bad, "m", present=True)
    shown = drawn(view(telemetry, notices=(bad,)))
    assert len(shown) <= 26  # with the fourth sensor, and text without a place to break
    assert all(len(row) <= 80 and row.isprintable() for row in shown)
    assert "[bold]" in "\n".join(drawn(view(telemetry), width=300))


def test_a_number_of_any_size_fits() -> None:
    telemetry, network = listening()
    network.send(topics.BATTERY, Battery(voltage=1e300), NOW, maker="n")
    network.send(topics.RANGE, reading("rear", 1e308), NOW, name="rear", maker="n")
    assert all(len(row) <= 80 for row in drawn(view(telemetry)))


def test_the_place_on_the_map_is_told_where_anybody_tells_it() -> None:
    assert "MAP" not in "\n".join(drawn(view(heard())))
    assert "| map " not in view(heard()).line()
    telemetry = heard()
    Network(telemetry).send(topics.POSE, map_pose(0, Pose(1.5, 2.2, 0.0)), NOW)
    shown = drawn(view(telemetry, notices=("n" * 200,)))
    assert len(shown) <= 24
    assert "MAP  localized x 1.50 y 2.20 m, 0.0° ± 0.05 m, 1°" in [row.rstrip() for row in shown]
    assert not any(row.startswith("pose ") for row in shown)
    assert "| base driving | map localized x 1.50 y 2.20 m, 0.0° ± 0.05 m, 1° | 24.3 V" in view(telemetry).line()
    told = report(telemetry)["localization"]
    assert (told["state"], told["map"], told["age"]) == ("localized", "hall", 0.0)


def test_a_route_is_told_while_it_goes_on_and_for_half_a_minute_after_its_end() -> None:
    telemetry, network = listening()
    network.send(topics.POSE, map_pose(0, Pose(1.5, 2.2, 0.0)), NOW)
    network.send(topics.ATTITUDE, attitude(NOW), NOW)
    network.send(topics.ROUTE, route_state(1, "ended", "blocked"), NOW)
    assert "ROUTE" not in "\n".join(drawn(view(telemetry))), "nobody knows when it has ended"
    network.send(topics.ROUTE, route_state(2), NOW)
    shown = drawn(view(telemetry, notices=("n" * 200,)))
    assert "ROUTE  to kitchen, leg 2 of 5, 3.2 of 7.9 m" in [row.rstrip() for row in shown]
    assert len(shown) <= 24
    assert not any(row.startswith(("route ", "places ")) for row in shown)
    network.send(topics.ROUTE, route_state(2, "waiting", at=(4.1, 2.2), reason=Trouble(BLOCKED)), NOW)
    waits = f"to kitchen, waits in leg 2 of 5, 3.2 of 7.9 m: {BLOCKED} (at 4.10,2.20 m)"
    assert f"| route {waits} |" in view(telemetry).line()
    for state, told in (
        (
            route_state(2, "ended", "too_narrow", reason=Trouble("a gap")),
            "too narrow in leg 2 of 5, 3.2 of 7.9 m: a gap",
        ),
        (route_state(2, "ended", "arrived"), "arrived, 3.2 of 7.9 m"),
        (route_state(2, "arming", step=0), "arming, 3.2 of 7.9 m"),
    ):
        network.send(topics.ROUTE, state, NOW)
        assert f"| route to kitchen, {told} |" in view(telemetry).line()
    assert report(telemetry)["route"]["place"] == "kitchen"
    assert "not heard for 29 s" in route_text(telemetry.snapshot(NOW + 29 * SECOND))
    assert telemetry.snapshot(NOW + 31 * SECOND).route is None
    network.send(topics.ROUTE, NO_ROUTE, NOW)
    assert telemetry.snapshot(NOW).route is None


def test_how_a_robot_that_balances_holds_itself_is_told() -> None:
    assert "BALANCE" not in "\n".join(drawn(view(heard())))
    telemetry, network = listening()
    network.send(topics.ATTITUDE, attitude(NOW), NOW)
    network.send(topics.POSE, map_pose(0, Pose(1.5, 2.2, 0.0)), NOW)
    shown = drawn(view(telemetry, notices=("n" * 200,)))
    assert len(shown) <= 24
    assert "BALANCE  stands: leans 1.5°, -12 N m" in [row.rstrip() for row in shown]
    assert "| base driving | stands: leans 1.5°, -12 N m | map" in view(telemetry).line()
    network.send(topics.ATTITUDE, attitude(NOW, "off", "the gyroscope failed"), NOW)
    assert "| off, because the gyroscope failed: leans 1.5°" in view(telemetry).line()
    assert report(telemetry)["attitude"]["posture"] == "off"


def test_the_report_has_the_names_that_are_promised() -> None:
    told = report(heard())
    assert set(told) == {
        *("robot", "elapsed", "silence", "waiting", "path", "speed", "turn", "state", "why", "missing", "services"),
        *(
            "odometry",
            "ranges",
            "sensed",
            "lease",
            "guard",
            "base",
            "estop",
            "battery",
            "localization",
            "route",
            "attitude",
            "cameras",
        ),
        *("topics", "unreadable"),
    }
    assert (told["robot"], told["elapsed"], told["silence"]) == ("giraff", 12.34, 0.0)
    assert (told["path"], told["speed"], told["turn"], told["state"]) == (4.0, 0.4, 0.0, "driving")
    assert told["why"] == "1.23 m ahead; turn away"
    assert told["ranges"]["front_left"]["range"] == 1.23
    assert told["ranges"]["rear"]["state"] == "fault"
    reason = told["guard"]["forward"]["reason"]
    assert reason == {"what": "1.23 m ahead", "remedy": "turn away", "action": "", "argument": ""}
    assert (told["lease"]["operator"], told["battery"]["voltage"]) == ("joystick", 24.3)
    assert told["base"]["age"] == 0.0
    assert told["topics"]["odom"] == {"hz": 100.0, "lost": 0, "age": 0.0}
    assert told["services"]["base"] == 1


def test_the_report_of_nothing_says_so() -> None:
    told = report(Telemetry(), waiting="no robot")
    assert (told["waiting"], told["silence"], told["odometry"], told["ranges"]) == ("no robot", None, None, {})
    assert told["missing"] == ["base", "guard", "ranger", "odometry"]


def test_what_limits_is_told_whole_with_its_way_out() -> None:
    telemetry, network = listening()
    near = verdict(0.0, "blocked", "front_left", "front_left sees something at 0.31 m", "turn left or back up")
    assert limit_text(telemetry.snapshot(NOW)) == "1.23 m ahead; turn away"
    network.send(topics.GUARD, msgspec.structs.replace(guard(near), reason=NO_TROUBLE), NOW, maker="n")
    told = "forward blocked: front_left sees something at 0.31 m; turn left or back up"
    assert limit_text(telemetry.snapshot(NOW)) == told
    assert f"WHY  {told}" in "\n".join(drawn(view(telemetry)))
    network.send(topics.GUARD, guard(verdict()), NOW, maker="n")
    assert limit_text(telemetry.snapshot(NOW)) == ""
    network.send(topics.BASE, base(armed=False, reason="not armed; hold the hand level"), NOW, maker="n")
    assert limit_text(telemetry.snapshot(NOW)) == "not armed; hold the hand level"
    assert limit_text(Telemetry().snapshot(NOW)) == ""


def test_the_longest_of_all_fits_24_rows() -> None:
    telemetry, network = listening()
    long = verdict(0.0, "blocked", "rear", "r " * 200, "w " * 200)
    network.send(topics.GUARD, guard(long), NOW, maker="n")
    network.send(topics.BASE, base(armed=False, reason="b " * 200), NOW, maker="n")
    assert len(drawn(view(telemetry, notices=("n" * 200,)))) <= 24


def test_a_camera_that_is_on_says_who_sees_it() -> None:
    telemetry, network = listening()
    network.send(topics.CAMERA_STATE, camera(), NOW, name="head")
    network.send(topics.CAMERA_ON, Battery(voltage=0.0), NOW, name="head")  # of the state the key alone counts
    assert (" · camera" in drawn(view(telemetry))[0], "camera" in view(telemetry).line()) == (False, False)
    network.send(topics.CAMERA_STATE, camera("ann@desk"), NOW, name="head")
    shown = drawn(view(telemetry))
    assert "giraff · 0:12 · camera head is seen by ann@desk ─" in shown[0]
    assert len(shown) <= 24
    assert "| camera head is seen by ann@desk | 24.3 V |" in view(telemetry).line()
    assert report(telemetry)["cameras"]["head"]["askers"][0]["by"] == "ann@desk"
    assert "camera" not in view(telemetry, NOW + 2 * SECOND).line()
