"""What is typed wrong is told in one line, with the way out, and nothing is done."""

from pathlib import Path

import pytest

from giraff_cli.topic.echo import FieldError, selected
from tests.rules.repository import ROOT
from tests.unit.cli.quiet_network import meet
from tests.unit.cli.typed import Giraff

DRIVE = str(ROOT / "tests" / "unit" / "replay" / "data" / "drive.mcap")
ARDROS = str(ROOT / "deploy" / "robots" / "ardros.toml")
ROBOT, ROOM, PATTERN = (
    str(ROOT / "deploy" / file) for file in ("robot.toml", "worlds/flat.toml", "patterns/square.toml")
)
NO_ROOM = "robot.toml: it is a robot file, not a room; give it by --file or GIRAFF_CONFIG, and name a room here\n"
NO_ROBOT = "flat.toml: it is a room, not a robot file; give it by `giraff run --world` or --map, and name a robot file"
SETTING = "giraff param set: write `giraff param set guard.margin 0.3` (see giraff param set --help)"
BATTERY = ("topic", "pub", "battery")

ANGLES: tuple[tuple[tuple[str, ...], str], ...] = (
    (("move",), "missing argument 'DISTANCE'"),
    (("move", "nan"), "'nan' is no length: give metres, like 2 or -0.5"),
    (("move", "0"), "a move of 0 m goes nowhere"),
    (("move", "-1", "--sped", "1"), "--sped"),
    (("move", "1", "--speed", "0"), "0.0 must be 0.01 or more"),
    (("move", "1", "--speed", "inf"), "inf is no number to count with"),
    (("move", "1", "--time-limit", "nan"), "'--time-limit'"),
    (("turn", "90"), "90 is more than a turn in radians: 90deg, or 90rad"),
    (("turn", "--", "-90"), "-90 is more than a turn in radians: -90deg, or -90rad"),
    (("turn", "0"), "a turn of 0 turns nothing"),
    (("arc", "1"), "missing argument 'ANGLE'"),
    (("arc", "1", "-90"), "-90 is more than a turn in radians: -90deg, or -90rad"),
    (("arc", "-1", "90deg"), "a radius of -1 m is none: give one above 0; a negative angle goes to the right"),
    (("arc", "1", "0deg"), "an arc of 0 goes nowhere"),
    (("go",), "missing argument 'NAME|X,Y|PATTERN.toml'"),
    (("go", "1,"), "'1,' is no point: give x and y in metres, like 1.5,-2"),
    (("go", "-1", "2.5", "--frame", "map"), "go: write it as one word: giraff go -1,2.5 --frame map"),
    (("go", "1,", "2"), "go: write it as one word: giraff go 1,2"),
    (("go", "1,2", "--frame", "mop"), "'mop' is not one of"),
    (("go", "deploy", "--frame", "map"), "--frame, --speed and --time-limit are for a point"),
    (("go", "none.toml"), "go: none.toml: No such file or directory"),
    (("go", "kitchen", "--frame", "map"), "are for a point: a route goes as the robot file has it\n"),
    (("go", "dining", "table", "--speed", "1"), "are for a point: a route goes as the robot file has it\n"),
    (("go", "kitchen", "--sped", "1"), "go: there is no option --sped; see giraff go --help\n"),
    (("go", "kitchen", "1,2"), "go: 'kitchen,1,2' is no point: give x and y in metres, like 1.5,-2\n"),
    (("go", "kitchen!"), "go: kitchen!: No such file or directory; a point is X,Y, like 1.5,-2, and a place a name"),
    (("go", "1"), "go: 1: No such file or directory; a point is X,Y, like 1.5,-2"),
    (("go", "1,2,90deg"), "'1,2,90deg' is no point: give x and y in metres, like 1.5,-2\n"),
    (("go", "1", "1", "--speed", "1"), "write it as one word: giraff go 1,1 --speed 1\n"),
    (("go", "1", "--speed", "1", "1"), "write it as one word: write 1,1\n"),
    (("move", "1,5"), "1,5 has a comma: write 1.5"),
    (("turn", "1,5rad"), "1,5rad has a comma: write 1.5rad"),
    (("go", "/"), "go: /: Is a directory"),
    (("odom", "set"), "missing argument 'X,Y,YAW'"),
    (("odom", "set", "1", "2", "1.57"), "odom set: write it as one word: giraff odom set 1,2,1.57rad"),
    (("odom", "set", "1", "2", "90"), "write it as one word: giraff odom set 1,2,90deg"),
    (("odom", "set", "-1,2,90"), "odom set: 90 has no unit: -1,2,90deg, or -1,2,90rad"),
    (("odom", "set", "0,0,0"), "odom set: 0 has no unit: 0,0,0deg, or 0,0,0rad"),
    (("odom", "set", "1,2"), "'1,2' is no pose: give X,Y,YAW without a space, like 1.5,-2,90deg"),
    (("odom", "set", "1", "2"), "is no pose"),
    (("odom", "set", "0,0,0deg", "--yaw-sd", "-5deg"), "'--yaw-sd': -5deg is no deviation of an angle: give 0deg to"),
    (("odom", "set", "0,0,0deg", "--yaw-sd", "20"), "'--yaw-sd': 20 is more than a turn in radians: 20deg, or 20rad"),
    (("odom", "set", "0,0,0deg", "--position-sd", "nan"), "'--position-sd': nan is no number to count with"),
    (("odom", "set", "0,0,0deg", "--degree"), "no option --degree"),
    (("localize", "--at", "1.5,2.2,90"), "--at: 90 has no unit: 1.5,2.2,90deg, or 1.5,2.2,90rad"),
    (("localize", "--at", "-1,2"), "--at: '-1,2' is no pose: give X,Y,YAW without a space, like 1.5,-2,90deg"),
    (("localize", "--at", "1,2,3rad", "--global"), "one at a time"),
    (("localize", "--from", "drive.mcap"), "with --map FILE"),
    (("localize", "--from", "drive.mcap", "--map", "hall.toml", "--robot", "anne"), "a recording is of one already"),
    (("localize", "--from", "drive.mcap", "--map", "hall.toml", "--for", "3"), "and has an end"),
)
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
    (
        ("topic", "pub", "maker/arm", '{"a": {"b": 18446744073709551616}}', "--robot", "x"),
        "giraff: a.b: 18446744073709551616 is beyond 64 bits: no message can hold it\n",
    ),
    (("topic", "pub", "param/guard/set", "{}", "--robot", "x"), "param/guard/set is asked, not published"),
    (("topic", "pub", "maker/**", "{}", "--robot", "x"), "a sample goes to one key"),
    (("topic", "pub", "cmd_vel/hänsel", "{}", "--robot", "x"), "stands for letters, digits, '-' and '_'"),
    (("topic", "echo", "odom", "--for", "inf"), "inf is no number to count with"),
    ((*BATTERY, '{"voltage": 1e999}', "--robot", "x"), "giraff: 1e999 is beyond 64 bits: no message can hold it\n"),
    (("param", "set", "guard.margin", "99999999999999999999"), "guard.margin: 99999999999999999999 is beyond 64 bits"),
    (("param", "set", "guard.margin", "-9223372036854775809"), "no message can hold it"),
    (("param", "set", "guard.margin", "[1, [18446744073709551616]]"), "18446744073709551616 is beyond 64 bits"),
    (("param", "set", "guard.margin", "9" * 200), "a number of 665 bits is beyond 64 bits"),
    (("param", "set", "guard.margin", "1e999"), "guard.margin: it is a number that no message can hold"),
    (("param", "set", "guard", "0.5"), "name service and field, like guard.margin"),
    (("record", "-o", "/proc/none/a.mcap", "--robot", "x"), "cannot be written: No such file"),
    (("record", "--max-size", "7"), "give 100k at least"),
    *(
        (("record", "--max-size", size), f"--max-size {size}: it is no size; give one like 500k, 20MB or 4GiB")
        for size in ("4XB", "4TB", "1,5GB", "nan", "inf", "-1GB")
    ),
    (("play", "nothing.mcap"), "No such file"),
    (("play", "/etc/hostname"), "not an MCAP file"),
    (("topic", "eco", "odom"), "giraff topic: no command 'eco': did you mean echo? (see giraff topic --help)"),
    (("top", "--onec"), "giraff top: no option --onec: did you mean --once or --connect? (see giraff top"),
    (("topic", "echo"), "giraff topic echo: missing argument 'KEY' (see giraff topic echo --help)"),
    (("doctor", "extra"), "giraff doctor: got unexpected extra argument(s) (extra) (see giraff doctor --help)"),
    (("estop", "status", "--timeout"), "giraff estop status: option '--timeout' requires an argument (see"),
    (("estop", "status", "--timeout", "inf"), "giraff estop status: invalid value for '--timeout': inf is no number"),
    (("watch", "--for", "inf"), "giraff watch: invalid value for '--for': inf is no number to count with"),
    (("watch", "--for", "-1"), "giraff watch: invalid value for '--for': -1.0 must be 0.1 or more"),
    (("watch", "--for", "nan"), "giraff watch: invalid value for '--for': nan is no number to count with"),
    (("why", "--for", "soon", "--json"), "giraff why: invalid value for '--for': 'soon' is no number"),
    (
        ("topic", "pub", "battery", "{}", "--rate", "1e9"),
        "giraff topic pub: invalid value for '--rate': 1000000000.0 must be between 0.01 and 1000.0",
    ),
    (("dst", "--seeds", "0"), "giraff dst: invalid value for '--seeds': 0 must be 1 or more"),
    (("param", "set", "guard.margin"), "giraff param set: missing argument 'VALUE'"),
    (("dst", "--seeds", "two"), "'--seeds': 'two' is no whole number"),
    (("run", "--seed", "1.5"), "'--seed': '1.5' is no whole number"),
    (("web", "--port", "x"), "'--port': 'x' is no whole number"),
    (
        ("ros2", "--namespace", "/r1"),
        "ros2: namespace is '/r1': write names of ROS, like r1 or lab/r1, without a slash",
    ),
    (("ros2", "--domain", "233"), "'--domain': 233"),
    (("ros2", "--distribution", "foxy"), "'foxy' is not one of 'humble', 'jazzy', 'kilted'"),
    (("run", "--world", "map.yaml"), "map.yaml: it is a grid of ROS's map_server, and this takes a room (.toml)"),
    (("run", "--boards", "arm"), "'arm' is not one of 'avr', 'host'"),
    (("map", "show", "none.toml"), "none.toml: cannot be read: No such file or directory"),
    (("topic", "echo", "odom", "--robot", "a/b"), "'a/b' cannot be part of a key: use letters, digits, '-' and '_'"),
    (("topic", "echo", "odom", "--robot", '"nina"'), "cannot be part of a key: use letters, digits, '-' and '_'"),
    (("topic", "hz", "--connect", "otto:x"), "giraff: --connect: 'otto:x': 'x' is no port from 1 to 65535; give"),
    (
        ("doctor", "--connect", "robot:abc"),
        "giraff: --connect: 'robot:abc': 'abc' is no port from 1 to 65535; give HOST",
    ),
    (
        ("topic", "hz", "--connect", "[::1]:9"),
        "; robots listen at IPv4 alone; give its IPv4 address; check",
    ),
    ((*BATTERY, '{"voltage": null}', "--robot", "x"), "not a Battery: voltage must be a number, and is none; it has"),
    ((*BATTERY, "[]", "--robot", "x"), "a Battery is a JSON object, like"),
    (("topic", "pub", "tick", '{"epoch": 1.5, "robot_ns": 1}', "--robot", "x"), "epoch must be a whole number"),
    (
        ("topic", "pub", "tilt", '{"x": 0, "y": 0, "z": 0, "status": "fine", "tick": null}', "--robot", "x"),
        "status cannot be",
    ),
    (("calibrate", "odometry", "--fit", "a", "--check", "b", "--metadata", "m", "--file", "f"), "leave --file out"),
    (("calibrate", "odometry", "--fit", "/etc/hostname", "--check", "a", "--file", "no.toml"), "no robot file at"),
    (("calibrate", "joystick", "--file", "no.toml"), "no robot file at"),
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
    (("view", "a.mcap", "--save", "a.mcap"), "--save a.mcap: it is the recording itself, which would be lost; name"),
    (("view", "none.mcap", "--save", "out.rrd"), "No such file"),
    (("view", "/etc/hostname", "--save", "out.rrd"), "not an MCAP file"),
    (("encoder", "disk", "--pairs", "500"), "pairs is 500: at most 94 fit on an inner diameter of 30 mm"),
    (("encoder", "disk", "--hole", "nan"), "hole is nan: it must be within 0.5..400 mm"),
    (("vision",), "name a recording or a video with --from FILE; a live robot is seen with giraff view --camera, or"),
    (("vision", "--from", "none.mcap"), "none.mcap: No such file or directory"),
    (("vision", "--from", "none.mp4"), "none.mp4: No such file or directory"),
    (("vision", "--from", "/etc"), "/etc: it is no file, but a folder"),
    (("vision", "--from", "/etc/hostname"), "hostname: OpenCV cannot read it as a video; give"),
    (("vision", "--from", DRIVE, "--file", "no.toml"), "--file no.toml: there is no such file"),
    (("vision", "--from", DRIVE), "no picture of head in it; record them with giraff record --camera"),
    (("vision", "--from", DRIVE, "--camera", "ear"), "--camera is 'ear', and the robot file's cameras are head: name"),
    (("vision", "--from", DRIVE, "--file", ARDROS), "the robot file has no camera; write [robot.sensors.head] with"),
    (
        ("view", DRIVE, "--picture", "a.png"),
        "no Vulkan driver is found here, and --picture draws with one; install one",
    ),
    (("view", "--port", "9000"), "--port 9000: it is for --web; add --web, or leave it out"),
    (("view", "drive.rrd"), "rerun itself opens what --save has written: rerun drive.rrd"),
    *ANGLES,
    (("run", "--world", ROBOT), NO_ROOM),
    (("map", "show", ROBOT), NO_ROOM),
    (("localize", "--from", DRIVE, "--map", ROBOT), NO_ROOM),
    (("map", "show", PATTERN), "square.toml: it is a pattern of steps, not a room; drive it by `giraff go`, and"),
    (("run", "--file", ROOM), NO_ROBOT),
    (("commission", "--file", ROOM), NO_ROBOT),
    (("tune", "balance", "--file", ROOM), NO_ROBOT),
    (("calibrate", "joystick", "--file", ROOM), NO_ROBOT),
    (("vision", "--from", DRIVE, "--file", PATTERN), "square.toml: it is a pattern of steps, not a robot file; drive"),
    (("go", ROBOT), "robot.toml: it is a robot file, not a pattern of steps; give it by --file or GIRAFF_CONFIG, and"),
    (("go", ROOM), "flat.toml: it is a room, not a pattern of steps; give it by `giraff run --world` or --map, and"),
    (("run", "--tilt-script", "none.csv"), "none.csv: cannot be read: No such file or directory; name a file of rows"),
    (("run", "--tilt-script", "/etc"), "--tilt-script: /etc: cannot be read: Is a directory; name a file of rows"),
    (("camera", "board", "/dev/full"), "/dev/full cannot be written: No space left on device; name another file"),
    (("camera", "board", "/proc/sys/kernel/ostype"), "ostype cannot be written: Permission denied; name another file"),
    (("record", "--repair", "none.mcap"), "giraff: none.mcap: No such file or directory"),
    (("record", "--repair", "/etc"), "/etc: it is no file, but a folder, a pipe or a device: give the file itself"),
    (
        ("topic", "list", "--connect", "nowhere.invalid"),
        "--connect nowhere.invalid: no such name is known here (DNS, /etc/hosts); give its address",
    ),
    (("map", "show", ROOM, "--svg", "none/a.svg"), "--svg none/a.svg: cannot be written: No such file"),
    (("map", "convert", "none.toml", "a.yaml"), "none.toml: cannot be read: No such file"),
    (("map", "convert", ROOM, "none/a.yaml"), "cannot be written: No such file"),
    (("map", "convert", ROOM, "a.pgm"), "name it .yaml"),
    (("map", "convert", ROOM, "a.yaml", "--resolution", "nan"), "--resolution"),
    (("run", "--for", "-3"), "--for -3: give a positive number of seconds"),
    (("run", "--for", "soon"), "giraff run: invalid value for '--for'"),
    (("run", "--world", "nowhere.toml"), "nowhere.toml: cannot be read: No such file"),
    (("run", "--summary", "missing/summary.json"), "cannot be written"),
    (("run", "--hand", "mine"), "'mine'"),
    (("run", "--file", "nowhere.toml"), "giraff run: invalid value for '--file': File 'nowhere.toml' does not exist"),
    (("run", "--file", "/etc/hostname"), "/etc/hostname: not TOML"),
    (("run", "--fast"), "giraff run: no option --fast"),
    (("wach",), "giraff: no command 'wach': did you mean watch? (see giraff --help)"),
    (("help",), "giraff: no command 'help': did you mean --help? (see giraff --help)"),
    (("version",), "giraff: no command 'version': did you mean --version? (see giraff --help)"),
    (("xyzzy",), "giraff: no command 'xyzzy' (see giraff --help)"),
    (("--verison",), "giraff: no option --verison: did you mean --version? (see giraff --help)"),
    (("why", "--robt", "x"), "giraff why: no option --robt: did you mean --robot? (see giraff why --help)"),
    (("param", "set", "--jsn"), "giraff param set: no option --jsn: did you mean --json? (see giraff param set"),
    (
        ("completion", "tcsh"),
        "giraff completion: invalid value for 'SHELL': 'tcsh' is not one of 'bash', 'zsh', 'fish'",
    ),
    (("completion",), "giraff completion: missing argument 'SHELL'"),
    (
        ("record", "out.mcap"),
        "giraff record: got unexpected extra argument(s) (out.mcap): the file is written as -o out.mcap",
    ),
    (("-x",), "giraff: no option -x (see giraff --help)"),
    (("param", "set", "guard.margin=0.3"), SETTING),
    (("param", "set", "guard", "margin", "0.3", "--robot", "x"), SETTING),
    (("param", "set", "guard.margin", "=", "0.3"), SETTING),
    (("param", "set", "a=b"), "giraff param set: write it like `giraff param set guard.margin 0.3` (see"),
    (("param", "set", "guard.margin", "0.3", "0.4"), "got unexpected extra argument(s) (0.4)"),
    (("param", "set", "guard.margin", "0.3", "--robot"), "option '--robot' requires an argument"),
    (
        ("dst", "--seeds", "2", "--json", "my sum.json"),
        "giraff dst: --json prints; write it as: giraff dst --seeds 2 --json > 'my sum.json' (see giraff dst --help)",
    ),
    (
        ("calibrate", "odometry", "--fit", "a.csv", "--check", "b.csv", "--json", "out.json"),
        "--json prints; write it as: giraff calibrate odometry --fit a.csv --check b.csv --json > out.json\n",
    ),
    (("map", "show", "--json", "room.toml", "extra"), "giraff map show: got unexpected extra argument(s) (extra)"),
    (("encoder", "disk", "--json"), "--json: name the drawing's file, which is standard output itself without a name"),
    (("camera", "view", "--json"), "--json tells of a picture that is written: add --save FILE"),
    (
        ("record", "--topics", "giraff/otto/odom", "--robot", "x"),
        "giraff/otto/odom is of otto, and --robot says x: leave",
    ),
    (
        ("record", "--topics", "giraff/otto/odom", "--topics", "giraff/anna/tick"),
        "giraff/anna/tick is of anna, and giraff/otto/odom of otto: leave out one of them",
    ),
    (("record", "--topics", "giraff/otto/odmo"), "no such topic; did you mean odom? there are tick, "),
    (("play", DRIVE, "--topics", "giraff/otto/odom"), "drive.mcap is of sim-test: leave out one of them"),
    (
        ("topic", "echo", "odom", "--field", "linaer_x"),
        "Odometry has no such field; did you mean linear_x? it has seq, ",
    ),
    (("logs", "bas"), "giraff logs: there is no service 'bas'; did you mean 'base'?\n"),
    (("logs", "base", "giraff@base"), "there is no service 'giraff@base'; known are: base, camera, door, "),
    (("logs", "--since", "yesterday"), "--since: 'yesterday' is no time: give one like 10min, 2h, 14:30 or 2026-"),
    (("logs", "-f", "--since", "14:75"), "--since: '14:75' is no time"),
    (("logs", "--since", "-5min"), "--since: '-5min' is no time"),
    (("logs", "--level", "loud"), "'--level': 'loud' is not one of 'info', 'warning', 'error'"),
)


def test_it_is_told_in_a_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, giraff: Giraff) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("GIRAFF_CONFIG", "GIRAFF_ROBOT_NAME", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("GIRAFF_NETWORK_LOCAL", "true")
    monkeypatch.setenv("COLUMNS", "40")
    monkeypatch.setenv("VK_DRIVER_FILES", "none.json")
    for words, said in ROWS:
        with monkeypatch.context() as patch:
            network = meet(patch)
            code, out, complaint = giraff(*words)
        assert (code, out) == (2, ""), words
        assert network.opened == 0 or words[0] not in ("move", "turn", "arc", "go", "odom", "localize"), words
        [_line] = complaint.splitlines()
        assert said in complaint, words
        assert list(tmp_path.iterdir()) == [], words


@pytest.mark.parametrize(
    ("field", "said"), [("tick.ms", "there is no ms; there are: epoch, robot_ns"), ("x.y", "it has no parts")]
)
def test_a_part_of_a_sample_that_it_has_not_is_told(field: str, said: str) -> None:
    with pytest.raises(FieldError, match=said):
        selected({"x": 0.5, "tick": {"epoch": 1, "robot_ns": 2}}, [field])
