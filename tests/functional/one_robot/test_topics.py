"""`giraff topic` beside a running robot."""

import json
import random
import signal
import time
from collections.abc import Mapping
from typing import Any, Final

import msgspec
import pytest

from giraff_cli.topic.publish import FILLED_IN
from giraff_schemas.messages import Battery, Sample
from giraff_schemas.topics import BATTERY, TOPICS
from giraff_tools.network.topic_keys import find_topic
from tests.functional.one_robot.answers import Holds, Scene, answers, at_once, document, in_json
from tests.support.desk import Desk, Done, run_beside
from tests.support.process_robot import SERVICES, ProcessRobot
from tests.support.talker import INSTANCE, talker

PUBLISHERS = {
    "tick": "base",
    "tilt": "joystick",
    "cmd_vel/joystick": "joystick",
    "lease": "guard",
    "range/front_left": "ranger",
    "range/front_right": "ranger",
    "range/rear": "ranger",
    "cmd_vel": "guard",
    "wheels": "base",
    "odom": "odometry",
    "base": "base",
    "battery": "base",
    "guard": "guard",
    "estop": "base",
}


KEYS: Final = {
    *PUBLISHERS,
    "attitude",
    "bumper/*",
    "scan/*",
    "motion",
    "motion/hold",
    "pose",
    "particles",
    "map",
    "places",
    "places/hold",
    "route",
    "camera/*/@full",
    "camera/*/@small",
    "camera/*/on",
    "camera/*/state",
    "visual_odom",
    "true_pose",
    "serial/*",
    "serial_write/*",
}
"""All that a list has. Nothing leans. Only base, guard, ranger, odometry and joystick are there."""


def is_whole_list(rows: Any) -> bool:
    makers = {row["key"]: [maker["service"] for maker in row["publishers"]] for row in rows if row["heard"]}
    return makers == {key: [service] for key, service in PUBLISHERS.items()}


def keys_of(listed: str) -> list[str]:
    """Of the table that people read."""
    return [line.split()[0] for line in listed.splitlines()[1:]]


def has_all_rates(done: Done) -> bool:
    rates = json.loads(done.stdout)["rates"] if done.stdout else []
    return {rate["key"]: rate["maker"]["service"] for rate in rates} == PUBLISHERS


def weighs_all(widths: Any) -> bool:
    return {width["key"] for width in widths} == set(PUBLISHERS)


NOBODY: Final = "nobody publishes range/left on sim-test; published there: tick, "
OF_NOBODY: Final = (
    "topic echo range/left",
    "topic hz range/left --for 0.3",
)
ASKED: Final[Mapping[str, Holds]] = {
    "topic list --all --for 1.5 --json": in_json(is_whole_list),
    "topic list --all --for 0.3": lambda done: set(keys_of(done.stdout)) == KEYS,
    "topic hz --for 1.5 --json": has_all_rates,
    "topic bw --for 1.5 --json": in_json(weighs_all),
    "topic echo odom --count 50 --json": at_once,
    "topic echo range/* --count 12 --field sensor --field tick.epoch --json": at_once,
    "topic echo estop --for 2": lambda done: done.returncode == 0,
} | dict.fromkeys(OF_NOBODY, lambda done: NOBODY in done.stderr)


def list_of_a_silent_one(desk: Desk) -> Done:
    with talker(desk.rendezvous, "sim-silent"):
        return desk.run("topic", "list", "--all", "--robot", "sim-silent", "--for", "0.3", "--json")


def rates_of_one_that_drops(desk: Desk) -> Done:
    """A robot that says 250 numbers at 500 Hz, of which some are left out, one is late and one is double."""
    dropped = set(random.Random(5).sample(range(1, 240), 37)) - {241, 242}
    seqs = [seq for seq in range(250) if seq not in dropped]
    late = seqs.index(245)
    seqs[late], seqs[late + 1] = seqs[late + 1], seqs[late]
    seqs.insert(late + 3, 244)
    words = ("topic", "hz", "battery", "--robot", "sim-drops", "--for", "4", "--json")
    with talker(desk.rendezvous, "sim-drops") as robot, desk.running(*words) as process:
        robot.say(BATTERY, Battery(voltage=24.0), seqs, 500.0)
        out, err = process.communicate(timeout=60.0)
    return Done(words, process.returncode, out, err)


def rates_so_far_at_ctrl_c(desk: Desk) -> Done:
    words = ("topic", "hz", "battery", "--robot", "sim-short", "--for", "600", "--json")
    with talker(desk.rendezvous, "sim-short") as robot, desk.running(*words) as process:
        robot.say(BATTERY, Battery(voltage=24.0), range(40), 20.0)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60.0)
    return Done(words, process.returncode, out, err)


SCENES: Final[Mapping[str, Scene]] = {
    "drops": rates_of_one_that_drops,
    "so far": rates_so_far_at_ctrl_c,
    "silent": list_of_a_silent_one,
}


@pytest.fixture(scope="module")
def told(desk: Desk) -> dict[str, Done]:
    """All that is only looked at."""
    return answers(desk, ASKED, SCENES)


def test_list_has_every_key_with_who_says_it_and_who_listens(told: Mapping[str, Done]) -> None:
    rows = {row["key"]: row for row in document(told["topic list --all --for 1.5 --json"])}
    assert [key for key, row in rows.items() if row["publishers"]] == list(PUBLISHERS)  # in the table's order
    assert set(rows) == KEYS
    assert [maker["service"] for maker in rows["tick"]["subscribers"]] == ["guard", "joystick", "ranger"]
    for key in ("tick", "cmd_vel", "wheels", "odom"):
        assert rows[key]["hz"] > 0.0, key
    assert keys_of(told["topic list --all --for 0.3"].stdout) == list(rows)


def test_list_has_what_nobody_says(told: Mapping[str, Done]) -> None:
    rows = document(told["silent"])
    assert [(row["key"], row["publishers"], row["heard"]) for row in rows] == [(row.key, [], 0) for row in TOPICS]


def test_info_tells_fields_quality_and_both_ends(desk: Desk) -> None:
    """Beside no command that listens to the battery, too."""

    def both_ends(found: Any) -> bool:
        return bool(found["row"]["publishers"] and found["row"]["subscribers"])

    asked = {
        "topic info range/rear --for 0.3 --json": in_json(both_ends),
        "topic info range/* --for 0.3": lambda done: "listened to by  guard" in done.stdout,
        "topic info battery --for 0.3 --json": in_json(lambda found: found["matching"] is False),
    }
    rear, text, _ = answers(desk, asked, {}).values()
    found = document(rear)
    assert (found["robot"], found["whole_key"]) == ("sim-test", "giraff/sim-test/range/rear")
    assert [maker["service"] for maker in found["row"]["publishers"]] == ["ranger"]
    assert [maker["service"] for maker in found["row"]["subscribers"]] == ["guard", "odometry"]
    assert found["matching"]
    fields = {field["name"]: (field["type"], field["doc"]) for field in found["fields"]}
    assert fields["range"] == ("float | None", "m from the sensor; only of an echo.")
    assert "robot_ns" in [field["name"] for field in found["parts"]["RobotTime"]]
    assert "m from the sensor; only of an echo." in text.stdout


def test_echo_tells_samples_as_they_come(told: Mapping[str, Done]) -> None:
    done = told["topic echo odom --count 50 --json"]
    assert (done.returncode, done.stderr) == (0, "")
    samples = [json.loads(line) for line in done.stdout.splitlines()]
    seqs = [line["sample"]["seq"] for line in samples]
    assert len(seqs) == 50
    assert seqs == sorted(set(seqs))
    assert set(samples[0]) == {"key", "sample"}
    done = told["topic echo range/* --count 12 --field sensor --field tick.epoch --json"]
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert {line["key"] for line in lines} == {"range/front_left", "range/front_right", "range/rear"}
    assert all(line["key"] == f"range/{line['sample']['sensor']}" for line in lines)
    assert all(line["sample"]["tick.epoch"] > 0 for line in lines)
    assert told["topic echo estop --for 2"].returncode == 0


def test_echo_ends_by_ctrl_c(desk: Desk) -> None:
    with desk.running("topic", "echo", "odom", "--field", "seq") as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stdout.readline().startswith("odom: seq: ")
        process.send_signal(signal.SIGINT)
        process.stdout.read()
        assert (process.wait(60.0), process.stderr.read()) == (0, "")


def test_hz_counts_what_was_dropped_on_purpose_and_its_rate(told: Mapping[str, Done]) -> None:
    done = told["drops"]
    assert (done.returncode, done.stderr) == (1, "")
    counted = json.loads(done.stdout)
    [rate] = counted["rates"]
    assert rate["maker"] == {"service": "base", "instance": INSTANCE}
    numbers = {name: rate[name] for name in ("sent", "heard", "lost", "reordered", "duplicated")}
    assert numbers == {"sent": 250, "heard": 213, "lost": 37, "reordered": 1, "duplicated": 1}
    assert rate["hz"] == pytest.approx(500.0, rel=0.001)
    assert counted["unreadable"] == {}


def test_hz_tells_of_each_key(told: Mapping[str, Done]) -> None:
    done = told["topic hz --for 1.5 --json"]
    rates = json.loads(done.stdout)["rates"]
    assert all(rate["sent"] == rate["heard"] + rate["lost"] for rate in rates)
    assert done.returncode == (1 if any(rate["lost"] for rate in rates) else 0)


def test_hz_tells_so_far_at_ctrl_c(told: Mapping[str, Done]) -> None:
    done = told["so far"]
    assert done.stderr == ""
    assert json.loads(done.stdout)["rates"][0]["heard"] > 0


def test_what_is_no_sample_is_counted_and_told(robot: ProcessRobot, desk: Desk) -> None:
    with desk.running("topic", "hz", "battery", "--for", "1.5", "--json") as process:
        while process.poll() is None:
            robot.observer.session.put(robot.observer.key(BATTERY), b"\xc1 no sample")
            time.sleep(0.1)
        out, _ = process.communicate(timeout=60.0)
    assert process.returncode == 1
    assert json.loads(out)["unreadable"]["battery"] > 0


def test_bw_weighs_the_payloads(told: Mapping[str, Done]) -> None:
    widths = {width["key"]: width for width in document(told["topic bw --for 1.5 --json"])}
    odom = widths["odom"]
    assert 200 < odom["smallest"] <= odom["largest"] < 400
    assert odom["bytes_per_second"] > 0.0


REFUSED = ("cmd_vel/joystick", "range/rear")


def test_pub_says_nothing_in_the_name_of_a_robot_that_is_there(robot: ProcessRobot, desk: Desk) -> None:
    """Not even what it has just said itself."""
    heard: dict[str, dict[str, Sample]] = {key: {} for key in REFUSED}

    def listen(key: str) -> None:
        robot.observer.listen(find_topic(key), lambda sample: heard[key].__setitem__(sample.instance, sample))

    for key in REFUSED:
        listen(key)
    robot.wait("a sample of each key", lambda: all(heard.values()), 60.0)

    def publish(key: str) -> Done:
        [sample] = heard[key].values()
        fields = {name: value for name, value in msgspec.to_builtins(sample).items() if name not in FILLED_IN}
        return desk.run("topic", "pub", key, json.dumps(fields), "--rate", "50", "--count", "20")

    refused = run_beside(publish, REFUSED)
    for key, done in refused.items():
        assert (done.returncode, done.stdout) == (2, ""), key
        [line] = done.stderr.splitlines()
        assert f"{key} " in line
        assert "the robot is there" in line
        assert ("giraff_client" in line) is key.startswith("cmd_vel")
    assert {key: len(makers) for key, makers in heard.items()} == dict.fromkeys(REFUSED, 1)


def test_pub_says_it_in_another_name_until_that_robot_comes(desk: Desk) -> None:
    def has_a_rate(done: Done) -> bool:
        return bool(done.stdout) and any(rate["hz"] for rate in json.loads(done.stdout)["rates"])

    words = ("topic", "pub", "battery", '{"voltage": 23.5}', "--robot", "sim-mine")
    with desk.running(*words, "--rate", "20", "--json") as publishing:
        asking = ("topic", "hz", "battery", "--robot", "sim-mine", "--for", "1", "--json")
        rates = desk.until(has_a_rate, *asking)
        [rate] = json.loads(rates.stdout)["rates"]
        assert rate["hz"] > 0.0
        assert rate["maker"]["service"] == ""
        with talker(desk.rendezvous, "sim-mine"):
            out, err = publishing.communicate(timeout=60.0)
    assert publishing.returncode == 1
    assert "battery is the robot's own word, and the robot is there (base)" in err
    told = json.loads(out)
    assert (told["robot"], told["key"], told["instance"]) == ("sim-mine", "battery", rate["maker"]["instance"])
    assert told["sent"] >= rate["heard"] > 0


def test_a_key_that_nobody_publishes_is_told_with_those_that_are(told: Mapping[str, Done]) -> None:
    for words in OF_NOBODY:
        done = told[words]
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)


def test_every_service_of_the_robot_is_still_there(desk: Desk, robot: ProcessRobot) -> None:
    """None of all this has harmed it."""

    def are_there(rows: Any) -> bool:
        return {maker["service"] for row in rows for maker in row["publishers"]} == set(SERVICES)

    desk.json_until(are_there, "topic", "list", "--for", "0.3")
    assert robot.accepted() > 0
