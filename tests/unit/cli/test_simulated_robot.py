"""What each process of a run is started with. No process is started here."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from unittest.mock import MagicMock

import pytest

from giraff_cli.run import simulated_robot
from giraff_cli.run.processes import ProcessGroup
from giraff_schemas.services import SIMULATED
from tests.unit.cli.test_plan import environment, plan

__all__ = ["environment"]  # of each test here

READY = b'{"ready":true,"ports":{"base":"/dev/base","joystick":"/dev/joystick","ranger":"/dev/ranger"}}\n'


@pytest.mark.parametrize("options", [(), ("web", "localize", "camera")])
def test_each_process_is_told_what_the_plan_has(
    options: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: dict[str, tuple[list[str], Mapping[str, str]]] = {}

    def start(self: ProcessGroup, name: str, module: str, words: Iterable[str], given: Mapping[str, str]) -> None:
        started[name] = [module, *words], given
        self.output(name).write_bytes(READY)

    monkeypatch.delenv("STATE_DIRECTORY", raising=False)
    monkeypatch.setattr(ProcessGroup, "start", start)
    monkeypatch.setattr(simulated_robot, "SimulatorClient", MagicMock())
    made = plan(**dict.fromkeys(options, True))
    assert simulated_robot.SimulatedRobot(made, "tcp/127.0.0.1:7447", tmp_path).start_simulator(MagicMock())

    services = [name for name in SIMULATED if name != "door"]
    services += ["web", "localization", "camera", "vision"] if options else []
    eye = ["simulated-camera"] if options else []
    assert [*started] == ["door", "simulator", *eye, *services]
    for name in ("door", *services):
        words, given = started[name]
        assert words == ["giraff_node", name]
        assert given["GIRAFF_LOCALIZATION_MAP"] == str(made.world)
        assert given["GIRAFF_VISION_CAMERA"] == made.camera
        assert given.get("GIRAFF_BASE_PORT") == (None if name == "door" else "/dev/base")
        assert given.get("STATE_DIRECTORY") == (None if name == "web" else str(tmp_path / "state"))
        assert Path(given["GIRAFF_WEB_ROOM"]).is_file() == bool(options)
        for each in eye:
            assert f"--at {given['GIRAFF_CAMERA_DEVICE']} " in " ".join(started[each][0])
