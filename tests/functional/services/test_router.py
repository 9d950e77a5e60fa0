"""The router's process: what it refuses, that it can be asked how it is, and its end."""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

from giraff_health.ask import WELL, ask
from giraff_tools.network.ports import free_port

ROBOTS = '[router.robots.anne]\nrobot = ["anne-pc"]\n'


def start(directory: Path, text: str) -> subprocess.Popen[str]:
    file = directory / "robot.toml"
    file.write_text("[router]\nsites = ['home', 'away']\n" + text)
    environment = {name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")}
    environment |= {"GIRAFF_CONFIG": str(file), "RUNTIME_DIRECTORY": str(directory)}
    command = [sys.executable, "-m", "giraff_node", "router"]
    return subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True)


def refused(directory: Path, text: str) -> str:
    """What it says when it does not start."""
    process = start(directory, text)
    _, said = process.communicate(timeout=60.0)
    assert process.returncode == 2
    assert "Traceback" not in said
    return said


def test_a_router_open_to_the_internet_does_not_start(tmp_path: Path) -> None:
    assert "may be reached from the internet" in refused(tmp_path, "mode = 'fixed'\n")


def test_a_table_without_its_robots_does_not_start(tmp_path: Path) -> None:
    assert "nobody may do anything" in refused(tmp_path, "")


def test_missing_keys_are_named_with_the_way_out(tmp_path: Path) -> None:
    said = refused(tmp_path, f"keys = '{tmp_path}/nowhere'\n{ROBOTS}")
    assert "ca.pem: No such file or directory" in said
    assert "giraff keys host" in said


def test_an_address_that_is_taken_is_named(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        address = f"127.0.0.1:{taken.getsockname()[1]}"
        said = refused(tmp_path, f"mode = 'fixed'\nlisten = ['{address}']\n")
    assert address in said
    assert "is another program at that address" in said


def test_it_says_that_it_is_well_and_ends_when_told_to(tmp_path: Path) -> None:
    process = start(tmp_path, f"mode = 'fixed'\nlisten = ['127.0.0.1:{free_port()}']\n")
    try:
        deadline = time.monotonic() + 60.0
        while not (tmp_path / "router.sock").exists():
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.05)
        answer = ask(str(tmp_path / "router.sock"))
        assert WELL in answer
        assert b'"service":"router"' in answer
    finally:
        process.send_signal(signal.SIGTERM)
        _, said = process.communicate(timeout=60.0)
    assert process.returncode == 0
    assert "any robot and anybody" in said
    assert '"message":"ended"' in said
