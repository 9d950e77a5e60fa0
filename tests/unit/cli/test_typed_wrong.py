"""What is typed wrong is told in one line, with the way out, and nothing is done."""

from __future__ import annotations

from pathlib import Path

import pytest

from giraff_cli.topic.echo import FieldError, selected
from tests.rules.repository import ROOT
from tests.unit.cli.quiet_network import meet
from tests.unit.cli.typed import typed

DRIVE = str(ROOT / "tests" / "unit" / "replay" / "data" / "drive.mcap")
BATTERY = ("topic", "pub", "battery")

ROWS: tuple[tuple[tuple[str, ...], str], ...] = (
    ((*BATTERY, '{"volts": 3}', "--robot", "x"), "not a Battery: `voltage` is missing"),
    ((*BATTERY, "3 V", "--robot", "x"), "not JSON"),
    (("topic", "pub", "range/*", "{}", "--robot", "x"), "name what `*` stands for"),
    ((*BATTERY, '{"voltage": 3}'), "--robot NAME is missing"),
    (
        ("topic", "pub", "batery", "{}", "--robot", "x"),
        "nobody publishes batery and nobody listens to it; did you mean battery?",
    ),
    ((*BATTERY, '{"voltage": 3}', "--robot", "x", "--rate", "nan"), "nan is no number to count with"),
    (("topic", "echo", "odom", "--field", "z"), "Odometry has no such field; it has seq, stamp_ns"),
    (("topic", "echo", "a//b"), "'a//b' is no key: give one like odom or maker/arm"),
    (("topic", "hz", "giraff/otto/odom", "--robot", "x"), "giraff/otto/odom is of otto, and --robot says x"),
    (("topic", "echo", "estop/engage"), "estop/engage is asked, not published"),
    (("topic", "hz", "camera/front/@full"), "pictures must be asked for: giraff camera view"),
    (("topic", "pub", "maker/arm", "{angle: 1}", "--robot", "x"), "not JSON: it is wrong from character 2 on"),
    (("topic", "pub", "maker/arm", "[18446744073709551616]", "--robot", "x"), "18446744073709551616 is beyond 64 bits"),
    (("topic", "pub", "maker/**", "{}", "--robot", "x"), "a sample goes to one key"),
    (("topic", "pub", "cmd_vel/hänsel", "{}", "--robot", "x"), "stands for letters, digits, '-' and '_'"),
    (("topic", "echo", "odom", "--for", "inf"), "inf is no number to count with"),
    ((*BATTERY, '{"voltage": 1e999}', "--robot", "x"), "not JSON: it is a number that no message can hold"),
    (("param", "set", "guard.margin", "99999999999999999999"), "guard.margin: 99999999999999999999 is beyond 64 bits"),
    (("param", "set", "guard.margin", "-9223372036854775809"), "no message can hold it"),
    (("param", "set", "guard.margin", "[1, [18446744073709551616]]"), "18446744073709551616 is beyond 64 bits"),
    (("param", "set", "guard.margin", "9" * 200), "a number of 665 bits is beyond 64 bits"),
    (("param", "set", "guard.margin", "1e999"), "guard.margin: it is a number that no message can hold"),
    (("param", "set", "guard", "0.5"), "name service and field, like guard.margin"),
    (("odom", "set", "1", "2"), "missing argument 'YAW'"),
    (("odom", "set", "1", "two", "0"), "invalid value for 'Y': 'two' is not a valid float"),
    (("odom", "set", "nan", "0", "0"), "'X': nan is no number to count with"),
    (("odom", "set", "0", "-inf", "0"), "'Y': -inf is no number to count with"),
    (("odom", "set", "0", "0", "90"), "YAW 90 rad is more than a whole turn; if it is in degrees: --degrees"),
    (("odom", "set", "0", "0", "0", "--yaw-sd", "-0.1"), "'--yaw-sd': -0.1 is not in the range"),
    (("odom", "set", "0", "0", "0", "--position-sd", "nan"), "'--position-sd': nan is no number to count with"),
    (("odom", "set", "0", "0", "0", "--degree"), "--degree"),
    (("record", "--topics", "odmo"), "--topics odmo: no such topic; there are tick, "),
    (("record", "-o", "/proc/none/a.mcap", "--robot", "x"), "cannot be written: No such file"),
    (("record", "--max-size", "7"), "give 100k at least"),
    (("play", "nothing.mcap"), "No such file"),
    (("play", "/etc/hostname"), "not an MCAP file"),
    (("view", "--memory", "lots"), "'lots' is no amount of memory; give one like 500MB, 2GiB or 25%"),
    (("view", "--memory", "0"), "'0' is no amount of memory"),
    (("view", "--memory", "1MB"), "give 50MB at the least"),
    (("view", "--for", "-1"), "--for -1: give a positive number"),
    (("view", "--picture", "a.png"), "say when, with --for"),
    (("view", "--save", "a.rrd", "--web"), "one at a time"),
    (("view", DRIVE, "--robot", "otto"), "--robot and --connect are for a live robot"),
    (("view", DRIVE, "--picture", "a.gif"), "give a name that ends in .png"),
    (("view", DRIVE, "--picture", "no/such/a.png"), "there is no such folder"),
    (("view", DRIVE, "--save", "no/such/folder.rrd"), "No such file or directory"),
    (("view", DRIVE), "no screen here"),
    (("view", "none.mcap", "--save", "out.rrd"), "No such file"),
    (("view", "/etc/hostname", "--save", "out.rrd"), "not an MCAP file"),
)


@pytest.mark.parametrize(("words", "said"), ROWS, ids=[" ".join(words).replace(DRIVE, "FILE") for words, _ in ROWS])
def test_it_is_told_in_a_line(
    words: tuple[str, ...],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("GIRAFF_CONFIG", "GIRAFF_ROBOT_NAME", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("GIRAFF_NETWORK_LOCAL", "true")
    meet(monkeypatch)
    code, out, complaint = typed(monkeypatch, capsys, *words)
    assert (code, out) == (2, "")
    [line] = complaint.splitlines()
    assert said in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("field", "said"), [("tick.ms", "there is no ms; there are: epoch, robot_ns"), ("x.y", "it has no parts")]
)
def test_a_part_of_a_sample_that_it_has_not_is_told(field: str, said: str) -> None:
    with pytest.raises(FieldError, match=said):
        selected({"x": 0.5, "tick": {"epoch": 1, "robot_ns": 2}}, [field])
