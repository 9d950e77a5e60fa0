"""What holds of every `giraff` command that asks a robot: with no robot, with two, and into a closed pipe."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from giraff_schemas.topics import alive_key
from tests.desk.desk import Desk, Done, run_beside
from tests.system.robot import ProcessRobot

ASKING: tuple[tuple[str, ...], ...] = (
    ("why",),
    ("watch", "--for", "3"),
    ("estop", "status"),
    ("topic", "list"),
    ("topic", "info", "odom"),
    ("topic", "echo", "odom", "--for", "3"),
    ("topic", "hz", "odom", "--for", "1"),
    ("topic", "bw", "--for", "1"),
    ("node", "list"),
    ("node", "info", "base"),
    ("graph",),
    ("frames",),
    ("top", "--for", "3"),
)
"""Every command that asks a robot and changes nothing, with what it needs to be of use and to end by itself."""

Run = tuple[str, ...]
Ended = Mapping[Run, Done]

commands = pytest.mark.parametrize("words", ASKING, ids=[" ".join(words[:2]) for words in ASKING])


def run_all(desk: Desk, *more: str) -> Ended:
    """Every command of the table."""
    return run_beside(lambda words: desk.run(*words, *more), ASKING)


@pytest.fixture(scope="module")
def alone(desk: Desk) -> Ended:
    """On a network without a robot."""
    return run_all(desk.alone())


@pytest.fixture(scope="module")
def between_two(robot: ProcessRobot, desk: Desk) -> Ended:
    """With two robots, none of which is named."""
    with robot.observer.session.liveliness().declare_token(alive_key("sim-other", "base", "1")):
        return run_all(desk.unnamed())


@pytest.fixture(scope="module")
def misled(desk: Desk) -> Ended:
    """For a robot that is not there, where another one is."""
    return run_all(desk, "--robot", "otto")


def told(done: Done) -> str:
    """The one line on standard error of a command that could do nothing."""
    assert done.returncode == 2
    [line] = done.stderr.splitlines()
    return line


@commands
def test_with_no_robot_it_says_so(alone: Ended, words: Run) -> None:
    assert "no robot is heard on the network" in told(alone[words])
    assert "--connect ROBOT" in told(alone[words])


@commands
def test_with_two_robots_it_lists_them(between_two: Ended, words: Run) -> None:
    options = "--robot sim-other, --robot sim-test"
    assert told(between_two[words]) == f"giraff: several robots are on the network; name one: {options}"
    assert between_two[words].stdout == ""


@commands
def test_a_robot_that_is_not_there_is_named_with_those_that_are(misled: Ended, words: Run) -> None:
    assert "otto" in told(misled[words])
    assert "--robot sim-test" in told(misled[words])


@pytest.fixture(scope="module")
def unread(desk: Desk) -> Mapping[Run, tuple[int, str]]:
    """Exit code and complaints with a closed pipe for standard output."""

    def run(words: Run) -> Done:
        with desk.running(*words) as process:
            assert process.stdout is not None
            assert process.stderr is not None
            process.stdout.close()
            code = process.wait(60.0)
            return Done(words, code, "", process.stderr.read())

    return {words: (done.returncode, done.stderr) for words, done in run_beside(run, ASKING).items()}


@commands
def test_a_closed_pipe_ends_it_quietly(unread: Mapping[Run, tuple[int, str]], words: Run) -> None:
    code, complaints = unread[words]
    assert complaints == ""
    assert code in (0, 1)  # as far as it came, all was well, or not
