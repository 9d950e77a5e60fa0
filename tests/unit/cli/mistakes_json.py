"""What is typed wrong of `--json`, keys and parameters, and what is said of it."""

from __future__ import annotations

ROWS: tuple[tuple[tuple[str, ...], str], ...] = (
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
)
