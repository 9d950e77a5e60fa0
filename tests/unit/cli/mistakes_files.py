"""Files, disks and hosts that are not what a command needs, with what it says."""

from __future__ import annotations

ROWS: tuple[tuple[tuple[str, ...], str], ...] = (
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
