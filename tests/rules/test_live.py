"""Every field of a service's configuration says what may be done to it while the service runs, and so it is."""

import gc
import math
from collections.abc import Callable
from importlib import import_module
from types import FunctionType, MethodType, ModuleType
from typing import Any

import msgspec
import pytest

from giraff_base.policy import BasePolicy
from giraff_core.estop.latch import RELEASED
from giraff_core.live import Live
from giraff_core.parameters.table import ParamError, Parameters
from giraff_core.robot import RobotConfig
from giraff_core.tuning import Tuning, live_fields, loosens
from giraff_guard.config import GuardConfig
from giraff_guard.policy import GuardPolicy
from giraff_joystick.config import JoystickConfig
from giraff_joystick.policy import JoystickPolicy
from giraff_motion.config import MotionConfig
from giraff_motion.policy import MotionPolicy
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from tests.rules.repository import ROOT, services
from tests.support.robots import BASE, ROBOT

WITHOUT = {"giraff_router"}
"""Services that are no `Node` of a robot, and answer for no parameters."""
EXAMPLES: dict[str, msgspec.Struct] = {
    "base": BASE,
    "guard": GuardConfig(deceleration=1.5, run_on=0.12, room_behind=0.2),
}
"""Of those that cannot do with the defaults alone, or say more with others."""


def config_of(package: str) -> type[msgspec.Struct]:
    module = import_module(f"{package}.config")
    [found] = [
        value
        for value in vars(module).values()
        if isinstance(value, type) and issubclass(value, msgspec.Struct) and value.__module__ == module.__name__
    ]
    return found


CONFIGS = {package.removeprefix("giraff_"): config_of(package) for package in services() if package not in WITHOUT}
LIVE = [
    (service, name, live)
    for service, config in CONFIGS.items()
    for name, live in live_fields(config).items()
    if live not in (Tuning.READ_ONLY, None)
]


def example(service: str) -> msgspec.Struct:
    return EXAMPLES.get(service) or CONFIGS[service]()


@pytest.mark.parametrize("config", [*CONFIGS.values(), RobotConfig], ids=lambda config: config.__name__)
def test_each_field_is_classified(config: type[msgspec.Struct]) -> None:
    assert [name for name, live in live_fields(config).items() if live is None] == []


def test_a_field_that_nobody_has_classified_shows() -> None:
    config = msgspec.defstruct("Config", [("margin", float, 0.25)], frozen=True)
    assert live_fields(config) == {"margin": None}


@pytest.mark.parametrize(("service", "name", "live"), LIVE)
def test_no_live_value_is_taken_that_is_no_number(service: str, name: str, live: Tuning) -> None:
    params = Parameters(service, example(service), ROBOT)
    no_numbers: tuple[Any, ...] = (math.nan, math.inf, -math.inf, "nan", "a lot", [], {})
    for bad in no_numbers:
        before = params.config
        with pytest.raises(ParamError):
            params.set(name, bad)
        assert params.config is before
    assert live is not Tuning.READ_ONLY


@pytest.mark.parametrize(("service", "name", "live"), [row for row in LIVE if row[2] is not Tuning.FREE])
def test_safety_only_tightens(service: str, name: str, live: Tuning) -> None:
    params = Parameters(service, example(service), ROBOT)
    filed = getattr(params.config, name)
    tighter, looser = (filed * 1.02, filed * 0.98) if live is Tuning.RAISE_ONLY else (filed * 0.98, filed * 1.02)
    params.set(name, tighter)
    assert getattr(params.config, name) == tighter
    with pytest.raises(ParamError, match=r"is looser than .*: loosening takes the robot file, standstill"):
        params.set(name, looser)
    assert getattr(params.config, name) == tighter
    params.set(name, filed)


def test_what_is_not_measured_is_tighter_than_any_value() -> None:
    assert loosens(Tuning.LOWER_ONLY, None, 1.5)
    assert not loosens(Tuning.LOWER_ONLY, 1.5, None)
    assert not loosens(Tuning.LOWER_ONLY, None, None)
    assert loosens(Tuning.RAISE_ONLY, 1.0, math.nan)


POLICIES: list[tuple[Any, Callable[[Live[Any]], Any]]] = [
    (EXAMPLES["guard"], lambda live: GuardPolicy(live, ROBOT, 1)),
    (EXAMPLES["base"], lambda live: BasePolicy(live, ROBOT, RELEASED)),
    (JoystickConfig(), lambda live: JoystickPolicy(live, ROBOT, "one")),
    (OdometryConfig(), lambda live: OdometryPolicy(live, ROBOT)),
    (MotionConfig(), lambda live: MotionPolicy(live, ROBOT, "one")),
]


@pytest.mark.parametrize(("config", "make"), POLICIES, ids=[type(config).__name__ for config, _ in POLICIES])
def test_no_part_of_a_policy_goes_by_an_old_configuration(config: Any, make: Callable[[Live[Any]], Any]) -> None:
    """Neither by the object, nor by a value that was taken from it: the policy is as one made anew."""
    changed = msgspec.structs.replace(
        config,
        **{
            name: getattr(config, name) * 1.25
            for name, live in live_fields(type(config)).items()
            if live is not Tuning.READ_ONLY and getattr(config, name) is not None
        },
    )
    live = Live(config)
    policy = make(live)
    live.replace(changed)
    assert numbers_in(policy) == numbers_in(make(Live(changed)))
    assert not any(found is config for found in reached(policy))
    assert numbers_in(policy) != numbers_in(make(Live(config)))


@pytest.mark.parametrize("service", sorted({service for service, _, _ in LIVE}))
def test_a_service_with_a_live_parameter_takes_it(service: str) -> None:
    folder = ROOT / "services" / f"giraff_{service}"
    assert any(".on_reconfigured = " in path.read_text() for path in folder.glob("*.py"))


def reached(root: object) -> list[Any]:
    """All that an object of a policy holds, but for code and what is shared with other objects of its kind."""
    found: dict[int, Any] = {}
    waiting = [root]
    while waiting:
        one = waiting.pop()
        if id(one) in found or isinstance(one, type | ModuleType | FunctionType | MethodType):
            continue
        found[id(one)] = one
        waiting += gc.get_referents(one)
    return list(found.values())


def numbers_in(root: object, depth: int = 0) -> list[Any]:
    """The numbers in it, in order; of a configuration none but its own."""
    if isinstance(root, bool | int | float):
        return [root]
    if depth > 8 or isinstance(root, RobotConfig):
        return []
    if isinstance(root, msgspec.Struct):
        return [number for name in root.__struct_fields__ for number in numbers_in(getattr(root, name), depth + 1)]
    if isinstance(root, dict):
        return [number for value in root.values() for number in numbers_in(value, depth + 1)]
    if isinstance(root, list | tuple):
        return [number for value in root for number in numbers_in(value, depth + 1)]
    return [number for value in getattr(root, "__dict__", {}).values() for number in numbers_in(value, depth + 1)]
