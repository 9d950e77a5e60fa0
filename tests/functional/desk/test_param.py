"""`giraff param` against the simulated robot: what is set counts at once, what is saved counts after a restart."""

from __future__ import annotations

import json
import re
import statistics
import subprocess
import time
from collections.abc import Iterator

import pytest

from giraff_node.asking import Asking
from giraff_schemas.params import ParamSet
from giraff_schemas.topics import GUARD, PARAM_SET, alive_key
from tests.support.elsewhere import GIRAFF
from tests.support.process_robot import SERVICES, ProcessRobot, process_robot
from tests.timing.stalled import by_the_wall


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("param"), boards="host") as made:
        made.arm()  # and so the sensors have proved that they hear
        made.simulator.place(3.15, 0.0)  # 0.6 m before the wall
        yield made


def param(robot: ProcessRobot, *words: str, code: int = 0) -> tuple[str, str]:
    """What `giraff param` says, and complains of."""
    done = subprocess.run(
        [str(GIRAFF), "param", *words],
        check=False,
        capture_output=True,
        text=True,
        env=robot.environment,
        cwd=robot.directory,
        timeout=30.0,
    )
    assert done.returncode == code, (done.stdout, done.stderr)
    return done.stdout, done.stderr


def test_a_tightening_changes_the_verdict_within_a_fifth_of_a_second(robot: ProcessRobot) -> None:
    """What is taken back is free again once the sensors have said so anew: that takes longer, and is not timed."""
    heard: list[tuple[float, float]] = []
    robot.observer.listen(GUARD, lambda state: heard.append((time.monotonic(), state.forward.allowed)))

    def answered(margin: float) -> None:
        request = ParamSet(name="margin", value=margin, by="test")
        asking = Asking(robot.observer.session, "sim-test", PARAM_SET.at("guard"), request)
        robot.wait("an answer", lambda: asking.poll(time.monotonic()) is not None, 5.0)

    took, begin_ns = [], time.monotonic_ns()
    for _ in range(5):
        robot.wait("a free way", lambda: bool(heard) and heard[-1][1] > 0.4, 10.0)
        began = time.monotonic()
        answered(0.5)
        robot.wait("another verdict", lambda: heard[-1][1] < 0.2, 5.0)
        took.append(heard[-1][0] - began)
        answered(0.25)
    print("set to verdict:", [f"{seconds:.3f} s" for seconds in took])
    with by_the_wall(begin_ns):
        assert statistics.median(took) <= 0.2


def test_a_loosening_is_refused_with_the_rule(robot: ProcessRobot) -> None:
    out, err = param(robot, "set", "guard.margin", "0.1", code=1)
    assert out == ""
    assert err == (
        "giraff: guard.margin 0.1 is looser than 0.25: loosening takes the robot file, standstill and a restart\n"
    )
    assert param(robot, "get", "guard.margin")[0] == "0.25\n"


@pytest.mark.parametrize(
    ("words", "code", "complaint"),
    [
        (("set", "guard.margin", "nan"), 1, "margin is nan: it must be within 0.01..2 m"),
        (("set", "guard.marign", "0.5"), 1, "guard has no parameter marign; did you mean guard.margin?"),
        (("set", "base.battery_cutoff", "23"), 1, "battery_cutoff is 23.0: it must not be above battery_low"),
        (("set", "guard", "0.5"), 2, "name service and field, like guard.margin"),
        (("set", "gaurd.margin", "0.5"), 2, "no such service is heard of sim-test; there are base, guard, joystick"),
        (("get", "guard.marign"), 2, "guard.marign: no such parameter; guard has margin, release"),
        (("list", "--robot", "another"), 2, "no robot called another is heard"),
        (("save", "guard.marign"), 1, "did you mean guard.margin?"),
    ],
)
def test_what_cannot_be_is_refused_and_says_why(
    robot: ProcessRobot, words: tuple[str, ...], code: int, complaint: str
) -> None:
    out, err = param(robot, *words, code=code)
    assert (out, err.count("\n")) == ("", 1), err
    assert complaint in err


def test_everything_is_listed_and_described(robot: ProcessRobot) -> None:
    out, err = param(robot, "list")
    assert err == ""
    assert "guard.margin " in out
    assert out.count("robot.track_width") == 1
    told = json.loads(param(robot, "list", "--json")[0])
    assert {one["service"] for one in told} == set(SERVICES)
    [margin] = [one for one in told if one["name"] == "guard.margin"]
    assert margin | {"host": ""} == {
        "name": "guard.margin",
        "service": "guard",
        "host": "",
        "value": 0.25,
        "robot_file": 0.25,
        "saved": True,
        "type": "float",
        "live": "up",
        "doc": "m kept between the robot's footprint and an obstacle.",
    }
    text = param(robot, "describe", "guard.margin")[0]
    assert text.splitlines() == [
        "guard.margin = 0.25",
        "    m kept between the robot's footprint and an obstacle.",
        "    float; safety: may be raised live",
    ]
    assert json.loads(param(robot, "get", "base", "--json")[0])[0]["name"] == "base.port"


def test_a_reader_that_goes_is_no_fault(robot: ProcessRobot) -> None:
    command = f"'{GIRAFF}' param list | head -1"
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", command], check=False, capture_output=True, text=True, env=robot.environment
    )
    assert (done.returncode, done.stdout.count("\n"), done.stderr) == (0, 1, "")


def test_what_is_saved_survives_a_restart_and_never_loosens_the_robot_file(robot: ProcessRobot) -> None:
    assert param(robot, "set", "guard.margin", "0.5")[0] == (
        "guard.margin 0.5 (robot file: 0.25; NOT SAVED, until the service ends)\n"
    )
    param(robot, "set", "odometry.max_gap", "0.7")
    restart(robot, "guard")
    assert param(robot, "get", "guard.margin")[0] == "0.25\n"
    param(robot, "set", "guard.margin", "0.5")
    assert param(robot, "save", "guard")[0] == "guard.margin 0.5 (robot file: 0.25; saved)\n"
    assert json.loads((robot.state / "params" / "guard.json").read_text()) == {"margin": 0.5}
    restart(robot, "guard")
    assert param(robot, "get", "guard.margin")[0] == "0.5\n"
    assert re.search(r"guard.margin +0.5 .*robot file: 0.25; saved", param(robot, "list")[0])
    param(robot, "set", "guard.margin", "0.3")  # back, as far as the robot file goes
    param(robot, "set", "guard.margin", "0.24", code=1)
    robot.environment["GIRAFF_GUARD_MARGIN"] = "0.8"  # the robot file has become tighter than what was saved
    restart(robot, "guard")
    assert param(robot, "get", "guard.margin")[0] == "0.8\n"
    assert "is looser than 0.8" in robot.log("guard")
    del robot.environment["GIRAFF_GUARD_MARGIN"]
    (robot.state / "params" / "guard.json").write_text('{"margin": 0.')
    restart(robot, "guard")
    assert param(robot, "get", "guard.margin")[0] == "0.25\n"
    assert "guard.json is damaged" in robot.log("guard")
    assert param(robot, "get", "odometry.max_gap")[0] == "0.7\n"


def restart(robot: ProcessRobot, service: str) -> None:
    robot.stop(service)
    robot.start(service)


def test_a_folder_that_cannot_be_written_is_told(robot: ProcessRobot) -> None:
    folder = robot.state / "params"
    for file in folder.iterdir():
        file.unlink()
    folder.rmdir()
    folder.write_text("no folder")
    out, err = param(robot, "save", "odometry", code=1)
    assert out == ""
    assert "File exists; the value counts until a restart: make the folder writable" in err
    folder.unlink()


def test_who_does_not_answer_is_named(robot: ProcessRobot) -> None:
    """A service whose token is there and which is not; one that hangs cannot even be met."""
    with robot.observer.session.liveliness().declare_token(alive_key("sim-test", "sentry", "one")):
        out, err = param(robot, "list", code=1)
        assert "sentry did not answer" in err
        assert "guard.margin" in out
        assert "NOT CONFIRMED: sentry did not answer" in param(robot, "set", "sentry.again", "5", code=2)[1]
