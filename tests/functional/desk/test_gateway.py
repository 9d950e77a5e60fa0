"""The gateway as it really runs: a process, a pty for its Arduino, and somebody on the network."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from giraff_node import Publisher
from giraff_schemas.messages import SerialLine, SerialWrite
from giraff_schemas.topics import SERIAL, SERIAL_WRITE
from giraff_sim.board import ROOT
from giraff_tools.network.ports import free_port
from tests.support.observer import Observer
from tests.support.waiting import wait
from tests.unit.node.ports import FakePort


class Bench:
    """An Arduino, the gateway, and what is heard of it."""

    def __init__(self, directory: Path) -> None:
        self.arduino = FakePort(directory / "arduino")
        environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")},
            "GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"),
            "GIRAFF_ROBOT_NAME": "sim-test",
            "GIRAFF_NETWORK_RENDEZVOUS": f"127.0.0.1:{free_port()}",
            "GIRAFF_NETWORK_LOCAL": "true",
            "GIRAFF_GATEWAY_PORT": str(self.arduino.link),
            "GIRAFF_GATEWAY_NAME": "weather",
            "GIRAFF_GATEWAY_LONGEST_LINE": "64",
            "STATE_DIRECTORY": str(directory),
            "RUNTIME_DIRECTORY": str(directory),
        }
        self.log = directory / "gateway.log"
        with self.log.open("w") as log:
            command = [sys.executable, "-m", "giraff_node", "gateway"]
            self.process = subprocess.Popen(command, env=environment, stderr=log)
        self.observer = Observer(environment)
        self.heard: list[SerialLine] = []
        self.said = 0
        self.observer.listen(SERIAL, self.heard.append)
        self.to = Publisher(self.observer.session, "sim-test", SERIAL_WRITE.at("weather"), "test")
        self.until(lambda: self.says_and_hears("hello"), "the first line")

    def says_and_hears(self, text: str) -> bool:
        """A network that has just met misses the first samples; what is heard comes in its order."""
        self.said += 1
        self.arduino.say(f"{text} {self.said}\n".encode())
        with suppress(AssertionError):
            wait(lambda: f"{text} {self.said}" in self.texts(), 2.0)
        return f"{text} {self.said}" in self.texts()

    def texts(self) -> list[str]:
        return [line.text for line in self.heard]

    def logged(self, text: str) -> Callable[[], bool]:
        return lambda: text in self.log.read_text()

    def until(self, holds: Callable[[], bool], what: str, seconds: float = 60.0) -> None:
        wait(holds, seconds, what=lambda: f"{what}: {self.texts()} {self.log.read_text()}")

    def close(self) -> None:
        self.process.terminate()
        assert self.process.wait(60.0) == 0, self.log.read_text()
        self.observer.close()
        self.arduino.close()


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    made = Bench(tmp_path_factory.mktemp("gateway"))
    yield made
    made.close()


def test_lines_go_out_whole_whatever_they_look_like(bench: Bench) -> None:
    bench.heard.clear()
    for piece in (b"23.", b"5 \xc2", b"\xb0C\r", b"\n\n", b"bad \xff\r", b"y" * 100, b"\n"):
        bench.arduino.say(piece)
        time.sleep(0.05)
    bench.until(lambda: len(bench.heard) == 5, "five lines")
    assert bench.texts() == ["23.5 °C", "", "bad \ufffd", "y" * 64, "y" * 36]
    assert [line.replaced for line in bench.heard] == [0, 0, 1, 0, 0]
    assert [line.goes_on for line in bench.heard] == [False, False, False, True, False]
    assert {line.name for line in bench.heard} == {"weather"}
    first = bench.heard[0].seq
    assert [line.seq for line in bench.heard] == list(range(first, first + 5))
    bench.until(bench.logged("bytes that are no text were replaced"), "a notice")
    bench.until(bench.logged("longer than 64 bytes"), "a notice")


def test_what_is_written_reaches_the_arduino_and_comes_not_back(bench: Bench) -> None:
    bench.arduino.heard()
    bench.heard.clear()
    for number in range(20):
        bench.to.put(SerialWrite(name="weather", text=f"led {number}"))
    got = bytearray()

    def all_of_it() -> bool:
        got.extend(bench.arduino.heard())
        return got.count(b"\n") >= 20

    bench.until(all_of_it, "twenty lines")
    assert got.decode().split("\n") == [*(f"led {number}" for number in range(20)), ""]
    bench.to.put(SerialWrite(name="weather", text="z" * 64))
    bench.until(bench.logged("a text of 65 bytes was not written"), "a refusal")
    assert (bench.heard, bench.arduino.heard()) == ([], b"")


def test_an_arduino_that_is_unplugged_is_a_fault_until_it_is_back(bench: Bench) -> None:
    bench.arduino.unplug()
    bench.until(bench.logged("unplugged"), "a fault")
    bench.until(bench.logged("no such port; plug the board in"), "its way out")
    bench.to.put(SerialWrite(name="weather", text="to nobody"))
    bench.until(bench.logged("texts were not written"), "a notice")
    bench.arduino.plug()
    bench.until(lambda: bench.says_and_hears("back again"), "a line of the new one")
    assert bench.arduino.heard() == b""
    bench.until(bench.logged("recovered: port"), "its end")
