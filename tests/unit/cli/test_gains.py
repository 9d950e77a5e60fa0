"""The gains of a robot that balances are those of the physics in its robot file."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from giraff_base.config import BaseConfig
from giraff_base.drives.balancer.config import BalancerConfig
from giraff_cli.tune.gains import PERIOD, gains_of, sampled
from giraff_node.config.robot_file import load
from tests.rules.repository import ROOT


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
