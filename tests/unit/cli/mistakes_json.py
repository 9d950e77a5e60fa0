"""What is typed wrong of `--json`, keys and parameters, and what is said of it."""

from __future__ import annotations

from tests.rules.repository import ROOT

DRIVE = str(ROOT / "tests" / "unit" / "replay" / "data" / "drive.mcap")
SETTING = "giraff param set: write `giraff param set guard.margin 0.3` (see giraff param set --help)"
ROWS: tuple[tuple[tuple[str, ...], str], ...] = (
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
)
