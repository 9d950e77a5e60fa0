"""Paths that are no serial ports, each named with what to do."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from giraff_node.boards.serial_link import SerialLink

NO_PORTS: dict[str, tuple[Callable[[Path], object], str]] = {
    "folder": (Path.mkdir, "a folder, no serial port; correct `port` in the robot file"),
    "file": (Path.touch, "no serial port; correct `port`"),
    "fifo": (os.mkfifo, "no serial port; correct `port`"),
    "loop": (lambda path: path.symlink_to(path), "a link that leads to itself; correct `port`"),
    "null": (lambda path: path.symlink_to("/dev/null"), "no serial port; correct `port`"),
}


@pytest.mark.parametrize("kind", NO_PORTS)
def test_a_path_that_is_no_port_is_named_with_its_remedy(tmp_path: Path, kind: str) -> None:
    make, told = NO_PORTS[kind]
    make(tmp_path / kind)
    link = SerialLink(str(tmp_path / kind), 115200)
    assert not link.keep_open(0.0)
    assert f"{tmp_path / kind}: {told}" in str(link.fault)
