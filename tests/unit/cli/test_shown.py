"""What a person sees: the live view, the line, the summary."""

import io
import math
import re
from dataclasses import replace

import msgspec
import pytest
from rich.console import Console

from giraff_cli.run.screen import Frame, line, view
from giraff_cli.run.summary import BalanceSummary, Summary, summarize, to_json, to_text
from giraff_cli.run.telemetry import RunSnapshot, RunTelemetry
from giraff_core.kinematics.pose import Pose
from giraff_schemas import topics
from giraff_schemas.localization import LocalizationState
from giraff_schemas.messages import Battery
from giraff_sim.bodies.balancer.drawn import draw
from giraff_sim.truth import Level, TruthRanges, draw_truth
from giraff_sim.truth import Truth as Drawn
from giraff_sim.world.body import Balance
from giraff_telemetry.describe import battery_text
from giraff_telemetry.layout import ServiceStatus
from giraff_tools.terminal.screen import as_svg
from tests.support import balancer_file
from tests.unit.cli.map_poses import map_pose
from tests.unit.cli.samples import (
    MS,
    TYPES,
    Network,
    attitude,
    base,
    estop,
    guard,
    lease,
    odometry,
    reading,
    ten_seconds,
    truth,
    verdict,
)

SECOND = 1000 * MS
FRAME = Frame(
    robot="sim-here",
    boards="avr",
    seed=3,
    elapsed=12.3,
    seconds=600.0,
    hints=("drive it: .venv/bin/giraff drive", "stop it:  .venv/bin/giraff stop"),
    note="",
    services={"joystick": "alive", "guard": "alive", "base": "alive", "ranger": "silent", "odometry": "ended"},
    notices=(),
)


def rendered(snapshot: RunSnapshot, frame: Frame = FRAME, width: int = 80) -> list[str]:
    console = Console(file=io.StringIO(), width=width, height=24, color_system=None)
    with console.capture() as capture:
        console.print(view(snapshot, frame))
    return capture.get().splitlines()


def test_the_view_tells_all_of_it_on_80_by_24() -> None:
    shown = rendered(ten_seconds().snapshot(10 * SECOND), replace(FRAME, notices=("odometry ended by itself",)))
    assert len(shown) <= 24
    assert all(len(row) <= 80 for row in shown)
    text = "\n".join(shown)
    for wanted in (
        r"sim-here · avr boards · seed 3 · 0:12 of 10:00",
        r"odometry +4\.000 +0\.000 +0\.0",
        r"truth +4\.000 +0\.000 +0\.0",
        r"apart +0\.000",
        r"path +4\.00 m ",
        r"speed +0\.40 m/s",
        r"forward +2\.50",
        r"front left +1\.23 m █+·+ +5\.6",
        r"front right +clear ·+",
        r"rear +fault ·+",
        r"state +driving +24\.3 V",
        r"forward +0\.30 m/s +slow +1\.23 m ahead; turn away",
        r"turn right +1\.00 rad/s +free",
        r"passes +0\.40 m/s +-0\.20 rad/s +joystick",
        r"command +31 ms, p99 31, most 31",
        r"TOPICS +0 lost",
        r"cmd_vel/joystick +33\.3",
        r"wheels +100\.0",
        r"● joystick +● guard +● base +○ ranger +✗ odometry",
        r"odometry ended by itself",
    ):
        assert re.search(wanted, text), f"{wanted} is not in\n{text}"


def place(shown: list[str], word: str) -> tuple[int, int]:
    [found] = [(number, row.index(word)) for number, row in enumerate(shown) if word in row]
    return found


def test_nothing_moves_in_the_view_when_numbers_change() -> None:
    before = rendered(ten_seconds().snapshot(10 * SECOND))
    telemetry = ten_seconds()
    network = Network(telemetry)
    network.send(topics.RANGE, reading("front_left", None, "clear"), 10 * SECOND, name="front_left", maker="n")
    telemetry.see(truth(10 * SECOND, x=-123.4, speed=-0.6))
    after = rendered(telemetry.snapshot(10 * SECOND))
    for heading in ("POSE", "MOTION", "TILT", "RANGES", "BASE", "GUARD", "TOPICS", "SERVICES"):
        assert place(before, heading) == place(after, heading)


def localized(telemetry: RunTelemetry, state: LocalizationState = "localized", reason: str = "") -> RunTelemetry:
    """For three seconds it says to be 3 cm beside the truth."""
    network = Network(telemetry)
    for ms in range(10_000, 13_001, 100):
        network.send(topics.POSE, map_pose(ms * MS, Pose(5.5, 2.23, 0.0), state, reason), ms * MS)
        if ms % 200 == 0:
            telemetry.see(truth(ms * MS, x=4.0))
    return telemetry


def on_map(status: ServiceStatus, notices: tuple[str, ...] = ()) -> Frame:
    return replace(FRAME, services=FRAME.services | {"localization": status}, notices=notices)


def test_the_view_tells_the_place_on_the_map_in_a_row_that_is_there_anyway() -> None:
    snapshot = localized(ten_seconds()).snapshot(13 * SECOND)
    shown = rendered(snapshot, on_map("alive"))
    assert len(shown) <= 24
    assert shown[-1].rstrip() == "MAP  off 0.03 m, 0.0°  localized x 5.50 y 2.23 m, 0.0° ± 0.05 m, 1°"
    assert not any(row.startswith("MAP") for row in rendered(snapshot))
    failed = rendered(snapshot, on_map("alive", notices=("odometry ended by itself",)))
    assert len(failed) <= 24
    assert failed[-1].rstrip() == "odometry ended by itself"
    ended = rendered(snapshot, on_map("ended"))
    assert ended[-1].startswith("MAP  ended  ")
    starting = rendered(ten_seconds().snapshot(13 * SECOND), on_map("starting"))
    assert starting[-1].rstrip() == "MAP  starting  -"


def test_a_service_that_ended_takes_the_row_of_a_hint_and_its_cause_the_last_one() -> None:
    why = "port 18099 is in use: end what listens there (`ss -ltnp` shows it), or choose another by --port"
    frame = replace(FRAME, ended="web ended (exit code 2), see /tmp/web.log", notices=(why,), note="waits")
    shown = rendered(ten_seconds().snapshot(10 * SECOND), frame)
    assert [row.rstrip() for row in shown[1:3]] == [frame.ended, FRAME.hints[1]]
    assert len(shown) == 25, "the terminal cuts the last row off"
    assert " ".join(row.strip() for row in shown[-2:]) == why


def test_the_last_row_tells_how_to_see_by_the_camera_or_how_a_robot_balances() -> None:
    telemetry = ten_seconds()
    seen = rendered(telemetry.snapshot(13 * SECOND), replace(FRAME, look="see by it: giraff camera view"))
    Network(telemetry).send(topics.ATTITUDE, attitude(10 * SECOND), 10 * SECOND)
    balances = rendered(telemetry.snapshot(10 * SECOND))
    assert max(len(seen), len(balances)) <= 24
    assert seen[-1].rstrip() == "see by it: giraff camera view"
    assert balances[-1].rstrip() == "BALANCE  stands: leans 1.5°, -12 N m"


def test_the_line_tells_the_place_on_the_map() -> None:
    told = line(localized(ten_seconds()).snapshot(13 * SECOND), 0.0)
    assert told.endswith(" | map localized x 5.50 y 2.23 m, 0.0° ± 0.05 m, 1° | off 0.03 m, 0.0°")
    lost = line(localized(ten_seconds(), "lost", "drive on").snapshot(13 * SECOND), 0.0)
    assert " | map lost: drive on | off 0.03 m" in lost


def test_a_long_reason_is_cut_and_not_wrapped_and_a_wider_terminal_shows_more_of_it() -> None:
    telemetry = ten_seconds()
    network = Network(telemetry)
    long = verdict(0.0, clearance="blocked", sensor="rear", reason="r" * 60, remedy="w" * 20)
    network.send(topics.GUARD, guard(long), 10 * SECOND, maker="n")
    assert "r" * 60 + "; " + "w" * 20 in "\n".join(rendered(telemetry.snapshot(10 * SECOND), width=120))
    long = verdict(0.0, clearance="blocked", sensor="rear", reason="r" * 200, remedy="w" * 200)
    network.send(topics.GUARD, guard(long), 10 * SECOND, maker="n")
    network.send(topics.BASE, base(armed=False, reason="b" * 200), 10 * SECOND, maker="n")
    shown = rendered(telemetry.snapshot(10 * SECOND))
    assert len(shown) <= 24
    assert all(len(row) <= 80 for row in shown)
    assert sum("…" in row for row in shown) == 2


def test_an_emergency_stop_and_a_latch_show() -> None:
    telemetry = ten_seconds()
    network = Network(telemetry)
    network.send(topics.LEASE, lease("", ""), 10 * SECOND, maker="n")
    network.send(topics.BASE, base(armed=False, latch="left_stuck"), 10 * SECOND, maker="n")
    shown = "\n".join(rendered(telemetry.snapshot(10 * SECOND)))
    assert re.search("state +latched, left stuck", shown)
    assert re.search("passes .* rad/s +nobody", shown)
    network.send(topics.ESTOP, estop(engaged=True), 10 * SECOND, maker="n")
    assert re.search("state +EMERGENCY STOP", "\n".join(rendered(telemetry.snapshot(10 * SECOND))))
    assert "| base EMERGENCY STOP |" in line(telemetry.snapshot(10 * SECOND), 0.0)


def test_the_view_says_so_when_nothing_is_known() -> None:
    starting = replace(FRAME, seconds=None, services={"base": "starting"})
    text = "\n".join(rendered(RunTelemetry(TYPES, truth(0)).snapshot(0), starting))
    assert "silent" in text
    assert "0:12 ─" in text
    assert "○ base" in text


def test_the_line_is_one_line() -> None:
    shown = line(ten_seconds().snapshot(10 * SECOND), 12.34)
    assert shown.startswith("  12.3 s | x   4.00 y   0.00 m")
    assert "ranges 1.23 m  clear  fault | forward slow (front_left) | base driving | lost 0" in shown
    assert "\n" not in line(RunTelemetry(TYPES, truth(0)).snapshot(0), 0.0)


def summary(
    telemetry: RunTelemetry,
    failures: list[str] | None = None,
    truth: Level = "calibrated",
    drawn: Drawn | None = None,
) -> Summary:
    return summarize(
        telemetry,
        robot="sim-here",
        boards="avr",
        seed=3,
        truth=truth,
        drawn=drawn,
        began_ns=2 * SECOND,
        failures=failures or [],
    )


def test_the_summary_is_what_was_measured_and_for_people_fits_a_terminal() -> None:
    told = summary(ten_seconds(), ["guard ended by itself"])
    assert told.duration_s == 8.0
    assert told.distance_m == 4.0
    assert told.odom_error_m == pytest.approx(0.0, abs=1e-3)
    assert (told.closest_m, told.contacts, told.frames_lost, told.line_errors) == (0.42, 0, 0, 0)
    assert told.rates_hz[topics.ODOM.key] == pytest.approx(100.0)
    assert told.age_ms is not None
    assert told.age_ms.p99 == 31.0
    assert told.failures == ["guard ended by itself"]
    text = to_text(summary(ten_seconds()))
    assert max(map(len, text.splitlines())) <= 80
    assert "0.420 m, 0 contacts" in text
    assert "31.0 ms median, 31.0 ms p99" in text


def test_the_summary_as_json_has_the_names_that_are_promised() -> None:
    told = msgspec.json.decode(to_json(summary(ten_seconds())))
    assert {
        *("distance_m", "odom_error_m", "odom_error_deg", "odom_sigma_m", "odom_sigma_deg", "odom_mahalanobis"),
        *("within_ellipse", "truth", "drawn", "closest_m", "contacts", "frames_lost", "rates_hz", "age_ms"),
        *("duration_s", "seed", "boards", "skew_percent"),
    } <= told.keys()
    assert set(told["age_ms"]) == {"p50", "p99", "max"}


def test_the_summary_tells_how_well_it_knew_its_place() -> None:
    telemetry = ten_seconds()
    assert summary(telemetry).localization is None
    localized(telemetry, "lost", "no place fits; drive on, or tell it where it is with giraff localize --at X,Y,YAW")
    telemetry.see(truth(13 * SECOND + 200 * MS, x=7.0))
    lost = summary(telemetry)
    assert lost.localization is not None
    assert lost.localization.shares == {"lost": 1.0}
    known = summary(localized(ten_seconds()))
    assert known.localization is not None
    assert known.localization.error is not None
    assert known.localization.error.p95_m == pytest.approx(0.03, abs=1e-3)
    assert max(map(len, (to_text(lost) + to_text(known)).splitlines())) <= 80
    assert "place off by  0.030 m" in to_text(known)


def test_the_summary_does_not_make_up_what_nobody_heard() -> None:
    told = summary(RunTelemetry(TYPES, truth(2 * SECOND)))
    assert told.odom_error_m is None
    assert (told.odom_sigma_m, told.odom_mahalanobis, told.within_ellipse) == (None, None, None)
    assert told.age_ms is None
    assert told.rates_hz == {}
    assert to_text(told).count("unknown") == 5


def test_the_summary_says_odometrys_error_beside_what_odometry_takes_it_for() -> None:
    telemetry = ten_seconds()
    sure = odometry(10 * SECOND + 10 * MS, 4.0)
    doubtful = msgspec.structs.replace(sure, covariance=(9e-4, 0.0, 0.0, 16e-4, 0.0, math.radians(1.5) ** 2))
    Network(telemetry).send(topics.ODOM, doubtful, 10 * SECOND + 10 * MS, maker="m")
    told = summary(telemetry)
    assert (told.odom_sigma_m, told.odom_sigma_deg) == (0.05, 1.5)
    assert (told.odom_mahalanobis, told.within_ellipse) == (0.0, True)
    assert re.search("odometry off by  0.000 m.*\n +its own sigma  0.050 m, 1.50°,\n +truth within its", to_text(told))


@pytest.mark.parametrize(("sigma", "off", "word"), [(0.04, 1.15, "within"), (0.01, 4.58, "OUTSIDE")])
def test_the_summary_says_whether_the_truth_is_where_odometry_takes_it_to_be(
    sigma: float, off: float, word: str
) -> None:
    telemetry = RunTelemetry(TYPES, truth(0))
    network = Network(telemetry)
    for ms in range(0, 5001, 10):
        sample = odometry(ms * MS, 0.5e-3 * ms + 1e-5 * ms)
        sample = msgspec.structs.replace(sample, covariance=(sigma**2, 0.0, 0.0, 4.0, 0.0, 0.0))
        network.send(topics.ODOM, sample, ms * MS)
        if ms and ms % 200 == 0:
            telemetry.see(truth(ms * MS, x=0.5e-3 * ms))
    told = summary(telemetry)
    assert told.odom_mahalanobis == pytest.approx(off, abs=0.02)
    assert told.within_ellipse is (word == "within")
    assert f"truth {word} its 95 % ellipse" in to_text(told)
    assert max(map(len, to_text(told).splitlines())) <= 80


@pytest.mark.parametrize("level", ["calibrated", "uncalibrated"])
def test_the_summary_says_which_robot_was_drawn(level: Level) -> None:
    drawn = draw_truth(level, TruthRanges(), 3)
    told = summary(ten_seconds(), truth=level, drawn=drawn)
    assert (told.truth, told.drawn) == (level, drawn)
    text = to_text(told)
    assert f"true robot  {level}: wheels {drawn.left.scale - 1.0:+.2%} " in text
    assert f"motors {drawn.left.strength:.0%} {drawn.right.strength:.0%}" in text
    assert "camera" not in text
    seen = msgspec.structs.replace(told, rates_hz={"camera/head/state": 5.0})
    assert f"camera {drawn.camera.height_scale - 1.0:+.2%} high" in to_text(seen)
    assert max(map(len, to_text(seen).splitlines())) <= 80
    assert "exact: as its file says" in to_text(summary(ten_seconds(), truth="exact", drawn=Drawn()))


BODY = draw(balancer_file.DRIVE, balancer_file.ROBOT.track_width, 3)


def test_the_summary_tells_how_a_robot_that_balances_stood() -> None:
    telemetry = ten_seconds()
    assert summary(telemetry).balance is None
    places = ((0.0, False), (1.0, True), (1.05, True), (1.4, False), (2.0, True), (1.96, True))
    for second, (x, is_settled) in enumerate(places, 11):
        balance = Balance(lean_sd=0.01, falls=1, stands=True, is_settled=is_settled, sits_down_at=10.3)
        telemetry.see(replace(truth(second * SECOND, x=x), balance=balance, drawn=BODY))
    stood = BalanceSummary(lean_sd_deg=0.573, drift_m=0.05, falls=1, sat_down=False, drawn=BODY)
    assert summary(telemetry).balance == stood
    telemetry.sit()
    rests = [telemetry.is_at_rest]
    lies = Balance(lean_sd=0.02, falls=2, stands=False, is_settled=True, sits_down_at=10.3)
    telemetry.see(replace(truth(17 * SECOND, x=9.0), balance=lies, drawn=BODY))
    assert [*rests, telemetry.is_at_rest] == [False, True]
    told = summary(telemetry, truth="calibrated", drawn=Drawn())
    assert told.balance == msgspec.structs.replace(stood, sat_down=True)
    assert told.drawn is None, "it is of another body"
    assert msgspec.json.decode(to_json(told))["balance"]["drawn"]["body_mass"] == BODY.body_mass
    assert "balance  lean 0.57° sd, drifted 0.05 m, 1 fall, sat down" in to_text(told)
    assert f"calibrated: {BODY.body_mass:.1f} kg at " in to_text(told)
    assert max(map(len, to_text(told).splitlines())) <= 80


def test_the_picture_stands_alone() -> None:
    svg = as_svg(view(ten_seconds().snapshot(10 * SECOND), FRAME))
    assert svg.startswith("<svg")
    assert "sim-here" in svg.replace("&#160;", " ")
    assert "url(" not in svg.replace("url(#", "")
    assert as_svg(view(ten_seconds().snapshot(10 * SECOND), FRAME)) == svg


@pytest.mark.parametrize(("since", "text"), [(None, "24.3 V"), (11_520.0, "24.3 V, charged 3.2 h ago")])
def test_a_battery_tells_when_it_was_charged_where_base_has_seen_it(since: float | None, text: str) -> None:
    assert battery_text(Battery(voltage=24.3, since_charge=since)) == text
