"""What each process of a run is started with. No process is started here."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from unittest.mock import MagicMock

import msgspec
import pytest

from giraff_cli.run import simulated_robot
from giraff_cli.run.processes import ProcessGroup
from giraff_schemas.services import SIMULATED
from tests.unit.cli.test_plan import environment, plan

__all__ = ["environment"]  # of each test here

PORTS = {name: f"/dev/{name}" for name in ("base", "joystick", "ranger", "scan")}
LASER = '{ type = "ld19", x = 0.0, y = 0.0, yaw = 0.0 }'


@pytest.mark.parametrize("options", [(), ("web", "localize", "camera")])
def test_each_process_is_told_what_the_plan_has(
    options: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: dict[str, tuple[list[str], Mapping[str, str]]] = {}

    def start(self: ProcessGroup, name: str, module: str, words: Iterable[str], given: Mapping[str, str]) -> None:
        started[name] = [module, *words], given
        self.output(name).write_bytes(msgspec.json.encode({"ready": True, "ports": PORTS}) + b"\n")

    monkeypatch.delenv("STATE_DIRECTORY", raising=False)
    monkeypatch.setattr(ProcessGroup, "start", start)
    if options:
        monkeypatch.setenv("GIRAFF_ROBOT_SENSORS__LASER", LASER)
    monkeypatch.setattr(simulated_robot, "SimulatorClient", MagicMock())
    made = plan(**dict.fromkeys(options, True))
    assert simulated_robot.SimulatedRobot(made, "tcp/127.0.0.1:7447", tmp_path).start_simulator(MagicMock())

    services = [name for name in SIMULATED if name != "door"]
    services += ["scan", "web", "localization", "places", "camera", "vision"] if options else []
    eye = ["simulated-camera"] if options else []
    assert [*started] == ["door", "simulator", *eye, *services]
    for name in ("door", *services):
        words, given = started[name]
        assert words == ["giraff_node", name]
        assert given["GIRAFF_LOCALIZATION_MAP"] == str(made.world)
        assert given["GIRAFF_VISION_CAMERA"] == made.camera
        for board, port in PORTS.items():
            assert given.get(f"GIRAFF_{board.upper()}_PORT") == (None if name == "door" else port)
        assert given.get("STATE_DIRECTORY") == (None if name == "web" else str(tmp_path / "state"))
        assert Path(given["GIRAFF_WEB_ROOM"]).is_file() == bool(options)
        for each in eye:
            assert f"--at {given['GIRAFF_CAMERA_DEVICE']} " in " ".join(started[each][0])
