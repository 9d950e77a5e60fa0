"""`giraff param` against the simulated robot: what is set counts at once, what is saved counts after a restart."""

import json
import re
import time
from collections.abc import Iterator, Mapping
from typing import Any

import pytest

from giraff_node.network.query_client import QueryClient
from giraff_schemas.params import ParamAnswer, ParamDescribe, ParamSet
from giraff_schemas.topics import GUARD, PARAM_DESCRIBE, PARAM_SET, Query, RequestT, alive_key
from tests.support.desk import run_beside
from tests.support.process_robot import SERVICES, ProcessRobot, process_robot
from tests.support.zygote import run_giraff


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("param"), boards="host") as made:
        made.arm()  # and so the sensors have proved that they hear
        made.simulator.place(3.15, 0.0)  # 0.6 m before the wall
        yield made


def param(robot: ProcessRobot, *words: str, code: int = 0) -> tuple[str, str]:
    """What `giraff param` says, and complains of."""
    done = run_giraff(("param", *words), robot.directory, robot.environment, 60.0)
    assert done.returncode == code, (done.stdout, done.stderr)
    return done.stdout, done.stderr


def answered(robot: ProcessRobot, query: Query[RequestT, ParamAnswer], request: RequestT) -> ParamAnswer:
    """What the service says to a request."""
    asking = QueryClient(robot.observer.session, "sim-test", query, request)
    found: list[ParamAnswer] = []

    def is_answered() -> bool:
        found[:] = filter(None, [asking.poll(time.monotonic())])
        return bool(found)

    robot.wait("an answer", is_answered, 60.0)
    return found[0]


def set_margin(robot: ProcessRobot, value: float) -> ParamAnswer:
    """Of the guard, as a program sets it."""
    return answered(robot, PARAM_SET.at("guard"), ParamSet(name="margin", value=value, by="test"))


def value_of(robot: ProcessRobot, service: str, name: str) -> Any:
    told = answered(robot, PARAM_DESCRIBE.at(service), ParamDescribe())
    [value] = [param.value for param in told.params if param.name == name]
    return value


def test_a_tightening_changes_the_verdict_and_is_taken_back(robot: ProcessRobot) -> None:
    def allowed() -> float:
        state = robot.observer.newest(GUARD)
        return -1.0 if state is None else state.forward.allowed

    robot.wait("a free way", lambda: allowed() > 0.4, 60.0)
    assert set_margin(robot, 0.5).done
    robot.wait("another verdict", lambda: 0.0 <= allowed() < 0.2, 60.0)
    assert set_margin(robot, 0.25).done
    robot.wait("a free way again", lambda: allowed() > 0.4, 60.0)


MISTYPED = "guard.marign: no such parameter; did you mean guard.margin? guard has "
LOOSENING = ("set", "guard.margin", "0.1")
REFUSED: Mapping[tuple[str, ...], tuple[int, str]] = {
    LOOSENING: (
        1,
        "giraff: guard.margin 0.1 is looser than 0.25: loosening takes the robot file, standstill and a restart\n",
    ),
    ("set", "guard.margin", "nan"): (2, "margin is nan: it must be within 0.01..2 m"),
    ("set", "base.battery_cutoff", "23"): (2, "battery_cutoff is 23.0: it must not be above battery_low"),
    ("list", "guard.marign"): (2, MISTYPED),
    ("get", "guard.marign"): (2, MISTYPED),
    ("describe", "guard.marign"): (2, MISTYPED),
    ("save", "guard.marign"): (2, "did you mean guard.margin?"),
}
LISTED: tuple[tuple[str, ...], ...] = (
    ("list",),
    ("list", "--json"),
    ("describe", "guard.margin"),
    ("get", "base", "--json"),
)


@pytest.fixture(scope="module")
def told(robot: ProcessRobot) -> dict[tuple[str, ...], tuple[str, str]]:
    """What changes nothing, beside each other."""
    codes = {words: code for words, (code, _) in REFUSED.items()}
    return run_beside(lambda words: param(robot, *words, code=codes.get(words, 0)), [*LISTED, *REFUSED])


def test_what_cannot_be_is_refused_and_says_why(
    robot: ProcessRobot, told: Mapping[tuple[str, ...], tuple[str, str]]
) -> None:
    for words, (_, why) in REFUSED.items():
        out, err = told[words]
        assert (out, err.count("\n")) == ("", 1), err
        assert why in err
    assert told[LOOSENING][1] == REFUSED[LOOSENING][1]
    assert value_of(robot, "guard", "margin") == 0.25


def test_everything_is_listed_and_described(told: Mapping[tuple[str, ...], tuple[str, str]]) -> None:
    (out, err), (listed, _), (text, _), (got, _) = (told[words] for words in LISTED)
    assert err == ""
    assert "guard.margin " in out
    assert out.count("robot.track_width") == 1
    rows = json.loads(listed)
    assert {one["service"] for one in rows} == set(SERVICES)
    [margin] = [one for one in rows if one["name"] == "guard.margin"]
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
    assert text.splitlines() == [
        "guard.margin = 0.25",
        "    m kept between the robot's footprint and an obstacle.",
        "    float; safety: may be raised live",
    ]
    assert json.loads(got)[0]["name"] == "base.port"


def test_what_is_saved_survives_a_restart_and_never_loosens_the_robot_file(robot: ProcessRobot) -> None:
    assert param(robot, "set", "guard.margin", "0.5")[0] == (
        "guard.margin 0.5 (robot file: 0.25; NOT SAVED, until the service ends)\n"
    )
    assert answered(robot, PARAM_SET.at("odometry"), ParamSet(name="max_gap", value=0.7, by="test")).done
    restart(robot, "guard")
    assert value_of(robot, "guard", "margin") == 0.25
    assert set_margin(robot, 0.5).done
    assert param(robot, "save", "guard")[0] == "guard.margin 0.5 (robot file: 0.25; saved)\n"
    assert json.loads((robot.state / "params" / "guard.json").read_text()) == {"margin": 0.5}
    restart(robot, "guard")
    words = [("get", "guard.margin"), ("list", "guard")]
    (got, _), (listed, _) = run_beside(lambda each: param(robot, *each), words).values()
    assert got == "0.5\n"
    assert re.search(r"guard.margin +raise only +0.5 \(robot file: 0.25; saved", listed)
    assert set_margin(robot, 0.3).done  # back, as far as the robot file goes
    assert not set_margin(robot, 0.24).done
    robot.environment["GIRAFF_GUARD_MARGIN"] = "0.8"  # the robot file has become tighter than what was saved
    restart(robot, "guard")
    assert value_of(robot, "guard", "margin") == 0.8
    assert "is looser than 0.8" in robot.log("guard")
    del robot.environment["GIRAFF_GUARD_MARGIN"]
    (robot.state / "params" / "guard.json").write_text('{"margin": 0.')
    restart(robot, "guard")
    assert value_of(robot, "guard", "margin") == 0.25
    assert "guard.json is damaged" in robot.log("guard")
    assert value_of(robot, "odometry", "max_gap") == 0.7


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
    assert "File exists; the value counts until a restart; make the folder writable" in err
    folder.unlink()


def test_who_does_not_answer_is_named(robot: ProcessRobot) -> None:
    """A service whose token is there and which is not; one that hangs cannot even be met."""
    words: Mapping[tuple[str, ...], int] = {("list",): 1, ("set", "sentry.again", "5"): 2}
    with robot.observer.session.liveliness().declare_token(alive_key("sim-test", "sentry", "one")):
        told = run_beside(lambda each: param(robot, *each, code=words[each]), words)
    (out, err), (_, doubt) = told.values()
    assert "sentry did not answer" in err
    assert "guard.margin" in out
    assert "NOT CONFIRMED: sentry did not answer" in doubt
