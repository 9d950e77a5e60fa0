"""The table `[guard]`: what it takes, and what it refuses by name."""

from __future__ import annotations

import math
from pathlib import Path

import msgspec
import pytest

from giraff_guard.config import GuardConfig
from giraff_node.config import ConfigError, load

NUMBERS = [name for name in GuardConfig.__struct_fields__ if name != "priorities"]


@pytest.mark.parametrize("field", NUMBERS)
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_number_that_makes_no_sense_is_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(msgspec.ValidationError, match=field):
        msgspec.convert({field: value}, GuardConfig)


def test_what_is_not_measured_is_unset() -> None:
    assert GuardConfig().deceleration is None


def test_priorities_are_a_table_of_their_own(tmp_path: Path) -> None:
    path = tmp_path / "robot.toml"
    path.write_text("[guard.priorities]\ncarer = 2\nchild = -1\n")
    assert load("guard", GuardConfig, {"GIRAFF_CONFIG": str(path)}).priorities == {"carer": 2, "child": -1}
    path.write_text('[guard.priorities]\ncarer = "first"\n')
    with pytest.raises(ConfigError, match="priorities"):
        load("guard", GuardConfig, {"GIRAFF_CONFIG": str(path)})
