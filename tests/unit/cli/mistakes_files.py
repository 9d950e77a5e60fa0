"""Files, disks and hosts that are not what a command needs, with what it says."""

from __future__ import annotations

from tests.rules.repository import ROOT

DRIVE = str(ROOT / "tests" / "unit" / "replay" / "data" / "drive.mcap")
ROBOT, ROOM, PATTERN = (
    str(ROOT / "deploy" / file) for file in ("robot.toml", "worlds/flat.toml", "patterns/square.toml")
)
NO_ROOM = "robot.toml: it is a robot file, not a room; give it by --file or GIRAFF_CONFIG, and name a room here\n"
NO_ROBOT = "flat.toml: it is a room, not a robot file; give it by `giraff run --world` or --map, and name a robot file"
ROWS: tuple[tuple[tuple[str, ...], str], ...] = (
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
)
