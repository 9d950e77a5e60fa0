"""What holds of every `giraff` command: a stop that goes nowhere is told, and a reader who has gone is no fault.

What they say without a robot, beside two, and of what a robot has not: tests/unit/cli/test_any_command.py.
"""

from pathlib import Path

from giraff_schemas.topics import alive_key
from giraff_tools.network.ports import free_port
from tests.support.desk import Desk, run_beside
from tests.support.process_robot import ProcessRobot
from tests.support.waiting import wait
from tests.unit.replay.drive import DRIVE

Words = tuple[str, ...]

WRITING: tuple[Words, ...] = (("topic", "list"), ("replay", str(DRIVE)))
"""On the network and without it. tests/functional/one_robot/test_watch.py has one that writes line by line."""


def test_with_no_robot_it_says_so(tmp_path: Path) -> None:
    done = Desk(tmp_path, f"127.0.0.1:{free_port()}").run("estop", "engage", "--robot", "sim-test", "--timeout", "1")
    assert (done.returncode, done.stdout) == (2, "")
    assert "NOT CONFIRMED after 1 s" in done.stderr
    assert "use the battery switch" in done.stderr
    assert "give --connect " in done.stderr


def test_with_two_robots_it_lists_them(robot: ProcessRobot, desk: Desk) -> None:
    with robot.observer.session.liveliness().declare_token(alive_key("sim-other", "base", "1")):
        done = desk.unnamed().run("estop", "status", "--timeout", "60")
    options = "--robot sim-other, --robot sim-test"
    assert done.stderr == f"giraff: several robots are on the network; name one: {options} (or GIRAFF_ROBOT_NAME)\n"
    assert (done.returncode, done.stdout) == (2, "")


def test_a_robot_that_is_not_there_is_named_with_those_that_are(desk: Desk) -> None:
    asked: tuple[Words, ...] = (("topic", "list"), ("why",))
    listed, why = run_beside(lambda words: desk.run(*words, "--robot", "otto"), asked).values()
    assert (listed.returncode, listed.stdout) == (2, "")
    assert "otto" in listed.stderr
    assert "--robot sim-test" in listed.stderr
    assert why.returncode == 2
    assert "no robot called otto is heard on the network; check that it is on" in why.stderr
    assert why.stderr.rstrip().endswith("on the network: --robot sim-test")


AFRESH: tuple[Words, ...] = (
    ("estop", "engage"),
    ("frames",),
    ("graph", "--for", "0.3"),
    ("node", "list"),
    ("odom", "reset"),
    ("param", "get", "guard.margin"),
    ("topic", "list", "--for", "0.3"),
    ("why",),
)
"""Verbs that no other test starts by their entry point: they are forked, see tests/support/zygote.py."""


ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0"}
"""A host whose locale has no letters but those of ASCII, as a container often is."""


def test_each_verb_that_is_forked_elsewhere_starts_afresh_whatever_the_locale(desk: Desk) -> None:
    file = desk.directory / "deploy" / "robot.toml"
    file.parent.mkdir()
    file.write_text("# Küche\n", encoding="utf-8")

    def answers(words: Words) -> bool:
        with desk.running(*words, **ASCII) as process:
            out, err = process.communicate(timeout=60.0)
        assert "Traceback" not in err, err
        print(words, process.returncode, out, err)
        return process.returncode in ((0, 1) if words == ("why",) else (0,)) and bool(out) and not err

    run_beside(lambda words: wait(lambda: answers(words), 60.0, what=f"no answer to {words}"), AFRESH)
    file.unlink()


def test_a_closed_pipe_ends_it_quietly(desk: Desk) -> None:
    for words in WRITING:
        with desk.running(*words) as process:
            assert process.stdout is not None
            assert process.stderr is not None
            process.stdout.close()
            assert process.stderr.read() == "", words
            assert process.wait() in (0, 1), words  # as far as it came, all was well, or not
