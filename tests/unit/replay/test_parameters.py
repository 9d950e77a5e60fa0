"""A recording keeps what the services go by, as they tell it, and a replay goes by that."""

from functools import partial
from itertools import takewhile
from pathlib import Path
from typing import cast

import msgspec
import pytest
import zenoh

from giraff_cli.record.recorder import RecordedParameters
from giraff_cli.replay.agreement import Agreement
from giraff_cli.replay.runner import agreements, replay
from giraff_core.parameters.table import Parameters
from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_mcap.metadata import ASKED
from giraff_mcap.raw_sample import RawSample
from giraff_mcap.reading import Recording, params_in
from giraff_mcap.tables import table_of
from giraff_mcap.writing import RecordingWriter
from giraff_odometry.config import OdometryConfig
from giraff_schemas.codec import encode, encoding_of
from giraff_schemas.params import ParamAnswer
from giraff_schemas.topics import PARAM_DESCRIBE, alive_key, key_of
from tests.support.one_process import Clock, Session
from tests.unit.mcap.recordings import ABOUT
from tests.unit.replay.drive import DRIVE

ALL = Recording(DRIVE)
ROBOT = table_of(ALL, "robot", RobotConfig)
FILED: dict[str, GuardConfig | OdometryConfig] = {
    "guard": table_of(ALL, "guard", GuardConfig),
    "odometry": OdometryConfig(),
}
INSTANCES = {
    service: next(ALL.samples((key,))).content()["instance"]
    for service, key in (("guard", "cmd_vel"), ("odometry", "odom"))
}


def told(service: str, robot: RobotConfig = ROBOT, margin: float | None = None) -> ParamAnswer:
    """Return all that a service of the drive goes by, or that its margin was set."""
    params: Parameters[GuardConfig | OdometryConfig] = Parameters(service, FILED[service], robot)
    if margin is not None:
        params.set("margin", margin)
    shown = params.describe(() if margin is None else ("margin",))
    return ParamAnswer(service=service, instance=INSTANCES[service], host="pc", done=True, params=shown)


def heard(answer: ParamAnswer, at_ns: int) -> RawSample:
    key = key_of(ALL.robot, PARAM_DESCRIBE.at(answer.service))
    return RawSample(at_ns, key, encode(answer), encoding_of(ParamAnswer))


def drive_with(path: Path, seconds: float, *answers: tuple[float, ParamAnswer], **about: str) -> Path:
    """So much of the drive, recorded where its robot file was not, with what was told so many s after its beginning."""
    end_ns = next(ALL.samples()).heard_ns + seconds * 1e9
    samples = [
        RawSample(each.heard_ns, each.topic, each.payload, each.encoding)
        for each in takewhile(lambda each: each.heard_ns < end_ns, ALL.samples())
        if params_in(each) is None
    ]
    samples += [heard(answer, samples[0].at_ns + round(after * 1e9)) for after, answer in answers]
    with RecordingWriter(path, ABOUT | about, to_wall_ns=0) as writer:
        writer.add(samples)
        writer.close("test")
    return path


def shares(path: Path) -> dict[str, Agreement]:
    return {each.key: each for each in agreements(Recording(path), {})}


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No robot file is at hand."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("GIRAFF_CONFIG", raising=False)


def test_what_the_services_told_is_gone_by_without_any_robot_file(tmp_path: Path) -> None:
    path = drive_with(tmp_path / "told.mcap", 12.0, (3.0, told("guard")), (3.0, told("odometry")))
    assert Recording(path).tables()["guard"]["margin"] == 0.25
    filed = shares(drive_with(tmp_path / "filed.mcap", 12.0, tables=ALL.about["tables"]))
    assert shares(path) == filed
    assert filed["cmd_vel"].compared > 500


def test_what_was_set_meanwhile_counts_from_its_turn_on(tmp_path: Path) -> None:
    margin = 0.65
    told_late = drive_with(
        tmp_path / "set.mcap", 12.0, (3.0, told("guard")), (3.0, told("odometry")), (8.0, told("guard", margin=margin))
    )
    found = shares(told_late)["cmd_vel"]
    assert found.equal < found.compared, "the recorded guard had no such margin"
    first = int(found.first.partition("seq ")[2].partition(":")[0])
    before = [each for each in ALL.samples(("cmd_vel",)) if each.seq == first]
    assert before[0].heard_ns - next(ALL.samples()).heard_ns >= 8.0e9


def test_what_no_service_can_have_told_is_named_and_not_gone_by(tmp_path: Path) -> None:
    [margin] = told("guard", margin=0.65).params
    forged = [
        msgspec.structs.replace(told("guard"), params=(msgspec.structs.replace(margin, name=name, value=value),))
        for name, value in (("margin", "abc"), ("margin.x", 1.0), ("nothing", 1.0))
    ]
    for index, answer in enumerate(forged):
        unread: dict[str, str] = {}
        path = drive_with(tmp_path / f"{index}.mcap", 6.0, (3.0, told("guard")), (3.0, told("odometry")), (5.0, answer))
        found = {each.key: each for each in agreements(Recording(path), unread)}
        assert list(unread) == ["param/guard"]
        assert found["cmd_vel"].share > 0.98
        assert found["cmd_vel"].compared > 200


def test_a_service_that_told_nothing_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    tables = {"tables": ALL.about["tables"], ASKED: "yes"}
    monkeypatch.setattr("giraff_cli.replay.runner.agreements", lambda *_: [Agreement(service="guard", key="guard")])
    replay(drive_with(tmp_path / "silent.mcap", 6.0, **tables), 0.98, as_json=False)
    assert "guard did not tell its parameters; it is taken to have gone by the robot file" in capsys.readouterr().err


def test_each_process_is_asked_as_it_comes_until_it_answers() -> None:
    clock = Clock()
    session = Session(clock)
    asked: list[str] = []
    answers = {"guard": told("guard"), "odometry": told("odometry")}

    def answer(service: str, _: bytes) -> tuple[float, bytes] | None:
        asked.append(service)
        return None if len(asked) == 1 else (0.01, msgspec.msgpack.encode(answers[service]))

    for service in answers:
        session.answer(key_of(ALL.robot, PARAM_DESCRIBE.at(service)), partial(answer, service))
    kept: list[RawSample] = []
    parameters = RecordedParameters(cast(zenoh.Session, session), ALL.robot)

    def follow(seconds: float) -> None:
        for _ in range(round(seconds / 0.1)):
            kept.extend(parameters.pop_all(clock.monotonic(), clock.monotonic_ns()))
            clock.sleep(0.1)

    with session.declare_token(alive_key(ALL.robot, "guard", INSTANCES["guard"])):
        follow(1.0)
        with session.declare_token(alive_key(ALL.robot, "odometry", INSTANCES["odometry"])):
            follow(1.0)
    assert [each.key.rpartition("/")[2] for each in kept] == ["guard", "odometry"]
    assert kept[0].payload == encode(told("guard"))
    assert asked == ["guard", "guard", "odometry"]
