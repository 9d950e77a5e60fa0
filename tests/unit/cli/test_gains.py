"""The gains of a robot that balances are those of the physics in its robot file."""

from pathlib import Path

import msgspec
import numpy as np
import pytest

from giraff_base.config import BaseConfig
from giraff_base.drives.balancer.config import BalancerConfig
from giraff_base.drives.balancer.stability import PERIOD, Gains, Loop
from giraff_node.config.robot_file import load
from giraff_setup.balancer.tune import STEP, gains_of, respond_to_step, sampled
from tests.rules.repository import ROOT
from tests.unit.cli.typed import Giraff


def of_the_file() -> BalancerConfig:
    drive = load("base", BaseConfig, {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robots" / "balancer.toml")}).drive
    assert isinstance(drive, BalancerConfig)
    return drive


def test_the_robot_file_has_the_gains_of_its_physics() -> None:
    drive = of_the_file()
    assert (drive.k1, drive.k2, drive.k3, drive.k4) == pytest.approx(gains_of(drive), abs=0.5)


def test_a_fall_grows_as_the_equations_say() -> None:
    a, _ = sampled(of_the_file())
    assert np.log(np.abs(np.linalg.eigvals(a)).max()) / PERIOD == pytest.approx(1 / 0.27, rel=0.02)


@pytest.mark.parametrize("times", [0.25, 1.0, 4.0])
def test_they_hold_it_with_a_period_of_delay_and_on_bodies_that_differ(times: float) -> None:
    drive = of_the_file()
    heavy = msgspec.structs.replace(drive, body_mass=drive.body_mass * 1.1, centre_height=drive.centre_height * 1.15)
    for body in (drive, heavy):
        a, b = sampled(body)
        gains = times * np.array(gains_of(drive))
        delayed = np.block([[a, b], [gains, np.zeros(1)]])
        assert np.abs(np.linalg.eigvals(delayed)).max() < 1.0


def test_jury_judges_the_loop_as_its_poles_do() -> None:
    drive, chance, seen = of_the_file(), np.random.default_rng(1), set[bool]()
    a, b = sampled(drive)
    for _ in range(200):
        gains = Gains(*map(float, np.array(gains_of(drive)) * np.exp(chance.uniform(-2.0, 2.0, 4))))
        for delay in (1, 3):
            delayed = np.zeros((4 + delay, 4 + delay))
            delayed[:4, :4], delayed[:4, 4:5], delayed[-1, :4] = a, b, gains
            delayed[4:-1, 5:] = np.eye(delay - 1)
            holds = Loop(drive.mechanics, gains).holds(delays=(delay,))
            assert holds == (np.abs(np.linalg.eigvals(delayed)).max() < 1.0)
            seen.add(holds)
    assert seen == {False, True}


def test_gains_without_place_and_speed_are_judged_by_the_lean_alone() -> None:
    mechanics = of_the_file().mechanics
    assert Loop(mechanics, Gains(744.0, 174.8, 0.0, 0.0)).has_margin
    assert not Loop(mechanics, Gains(744.0, 174.8, 0.0001, 0.0)).has_margin
    assert not Loop(mechanics, Gains(744.0, 10.0, 0.0, 0.0)).has_margin


def test_the_command_tells_the_gains_their_margin_and_how_to_try_them(giraff: Giraff, tmp_path: Path) -> None:
    text = (ROOT / "deploy" / "robots" / "balancer.toml").read_text(encoding="utf-8")
    (other := tmp_path / "robot.toml").write_text(text.replace("k1 = 744.0", "k1 = 150.0"), encoding="utf-8")
    code, out, _ = giraff("tune", "balance", "--file", str(other))
    assert code == 0, "a file that base refuses is what it mends"
    assert "computed: it stands with all four times 0.19 to 10, 0.19 to 6.1, 0.19 to 4.3 at 1, 2, 3 periods" in out
    assert "a step of 5 cm: it stays within 5 mm after 2.8 s, leans by 0.5 degrees and takes 6.7 N m at most" in out
    assert "in the file: the robot falls" in out
    assert "giraff param set base.drive.k1 744\n" in out
    assert any("⣀" in line for line in out.splitlines()) or "##" in out
    for wrong, told in (
        (ROOT / "deploy" / "robot.toml", "drive.type is 'wheels'"),
        (tmp_path / "none.toml", "no robot file"),
    ):
        code, _, complaint = giraff("tune", "balance", "--file", str(wrong))
        assert code == 2
        assert told in complaint


def test_a_step_begins_the_wrong_way_and_a_bound_on_the_torque_holds() -> None:
    drive = of_the_file()
    response = respond_to_step(drive, drive.gains)
    assert -0.01 < min(response.way) < -0.001, "the body must lean first"
    assert response.torque == pytest.approx(drive.k3 * STEP)
    stiff = Gains(*(5.0 * gain for gain in drive.gains))
    weak = respond_to_step(msgspec.structs.replace(drive, torque_max=31.0), stiff)
    assert weak.torque == 31.0
