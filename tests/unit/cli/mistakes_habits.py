"""Words of the command line that are mistyped, and the line that tells the word that was meant."""

from __future__ import annotations

ROWS: tuple[tuple[tuple[str, ...], str], ...] = (
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
)
