"""What computes on the balancing robot's board: its filter, and when it stands, sits down and is off."""

import re
from typing import Any, Final

import cffi
import numpy as np
import pytest

from giraff_schemas.wires.balancer import DRIVER_FULL, BalanceCause, BalanceFlag, BalancePosture, BalanceSide
from tests.firmware.builds import FIRMWARE, shared_library

PERIOD: Final = 0.005
MODULES: Final = ("balance", "inertial", "kalman", "wheel_speed", "watch", "posture", "reference", "torque")
TYPES: Final = re.compile(r"^(?:struct \w+ \{.*?^\};|enum \{[^}]*\};)", re.DOTALL | re.MULTILINE)
DECLARED: Final = """
void balance_start(void);
void balance_configure(const struct balance_settings *settings);
void balance_step(const struct balance_readings *readings, const struct balance_order *order);
const struct balance_state *balance_state(void);
void kalman_start(struct kalman *k);
void kalman_step(struct kalman *k, const struct kalman_input *in);
void torque_step(struct torque *t, const struct torque_input *in);
"""
SETTINGS: Final = {
    "k1": 744.0, "k2": 174.8, "k3": 133.2, "k4": 191.4, "gravity": 82.0, "momentum_per_speed": 15.7,
    "momentum_per_rate": 6.9, "radius": 0.175, "track": 0.55, "rad_per_count": 2 * np.pi / 5120,
    "motor_constant": 1.95, "motor_ohm": 0.35, "friction": 2.5, "torque_max": 70.0, "acceleration": 0.25,
    "braking": 0.35, "speed_max": 0.4, "turn_max": 0.8, "volts_min": 10.4,
}  # fmt: skip


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> tuple[cffi.FFI, Any]:
    ffi = cffi.FFI()
    headers = ("balance", "control", *MODULES[1:])
    texts = ((FIRMWARE / "balancer" / f"{name}.h").read_text() for name in headers)
    ffi.cdef("".join(block for text in texts for block in TYPES.findall(text)) + DECLARED)
    sources = (FIRMWARE / "balancer" / f"{name}.c" for name in MODULES)
    library = tmp_path_factory.mktemp("balance") / "balance.so"
    return ffi, ffi.dlopen(
        str(shared_library(library, *sources, includes=(FIRMWARE / "common", FIRMWARE / "balancer")))
    )


class Robot:
    """A board whose sensors show an upright robot that somebody holds."""

    def __init__(self, compiled: tuple[cffi.FFI, Any]) -> None:
        self._ffi, self._lib = compiled
        self._noise = np.random.default_rng(1)
        self._lib.balance_start()
        self.configure()
        self.readings: dict[str, Any] = {"counts": [0, 0], "volts": 12.0}
        self.order: dict[str, Any] = {"halts": True}
        self.sensors = np.array([471.0, 471.0, 512.0, 614.0])
        """Counts: both axes of the gyroscope, forward, up."""
        self.noise = np.full(4, 0.15)
        """Counts, of each."""
        self.turns = [0, 0]
        """Counts by which the wheels go to and fro each period."""

    def configure(self, **changes: float) -> None:
        self._lib.balance_configure(self._ffi.new("struct balance_settings *", SETTINGS | changes))

    def step(self, periods: int = 1) -> Any:
        for _ in range(periods):
            *gyro, forward, up = self.sensors + self.noise * self._noise.normal(0.0, 1.0, 4)
            self.turns = [-turn for turn in self.turns]
            if any(self.turns):
                self.readings["counts"] = [max(0, turn) for turn in self.turns]
            readings = {**self.readings, "gyro": gyro, "forward": forward, "up": up}
            self._lib.balance_step(
                self._ffi.new("struct balance_readings *", readings),
                self._ffi.new("struct balance_order *", self.order),
            )
        return self._lib.balance_state()

    def stand(self) -> None:
        self.order["may_stand"] = True
        assert any(self.step().posture == BalancePosture.STANDS for _ in range(1200))
        self.order["may_stand"] = False


@pytest.fixture
def robot(compiled: tuple[cffi.FFI, Any]) -> Robot:
    return Robot(compiled)


def exact_leans(gyro: np.ndarray, forward: np.ndarray, up: np.ndarray, axle: np.ndarray) -> list[float]:
    """The same filter as its equations are written: matrices, double precision. Every second period corrects, with the
    noise of two."""
    lean, covariance = np.zeros(2), np.diag([0.1**2, 0.06**2])
    advance, wander, seen = (
        np.array([[1.0, -PERIOD], [0.0, 1.0]]),
        np.diag([3e-6, 3e-8]) * PERIOD,
        np.array([[1.0, 0.0]]),
    )
    smooth, leans = np.array([0.0, 1.0]), []
    for k, (rate, f, u, a) in enumerate(zip(gyro, forward, up, axle / 9.81, strict=True)):
        smooth += PERIOD / 0.1 * (np.array([f, u]) - smooth)
        lean = advance @ lean + np.array([PERIOD * rate, 0.0])
        covariance = advance @ covariance @ advance.T + wander
        if k % 2:
            strange = abs(np.hypot(*smooth) - 1.0) + 0.5 * abs(a)
            gain = covariance @ seen.T / (seen @ covariance @ seen.T + (0.03**2 + strange**2) / 2)
            lean = lean + gain[:, 0] * (np.arctan2(a - smooth[0], smooth[1]) - lean[0])
            covariance = (np.eye(2) - gain @ seen) @ covariance
        leans.append(lean[0])
    return leans


@pytest.mark.parametrize("wild", [False, True])
def test_the_filter_is_within_a_tenth_of_a_degree_of_its_equations(compiled: tuple[cffi.FFI, Any], wild: bool) -> None:
    ffi, lib = compiled
    chance, count = np.random.default_rng(7), 6000
    t = np.arange(count) * PERIOD
    lean = np.radians(3.0) * np.sin(2.1 * t) + np.radians(1.5) * np.sin(6.7 * t)
    axle = 0.8 * np.sin(3.3 * t)
    if wild:
        lean, axle = chance.normal(0.0, 0.4, count).cumsum() * 0.01, chance.normal(0.0, 3.0, count)
    gyro = np.gradient(lean, PERIOD) + 0.05 + chance.normal(0.0, 0.005, count)
    forward = axle / 9.81 - np.sin(lean) + chance.normal(0.0, 0.3 if wild else 0.003, count)
    up = np.cos(lean) + chance.normal(0.0, 0.3 if wild else 0.003, count)
    filtered: Any = ffi.new("struct kalman *")
    lib.kalman_start(filtered)
    leans = []
    for k, (rate, f, u, a) in enumerate(zip(gyro, forward, up, axle, strict=True)):
        lib.kalman_step(filtered, ffi.new("struct kalman_input *", [rate, f, u, a, k % 2]))
        leans.append(filtered.lean)
    error = np.degrees(np.abs(np.array(leans) - exact_leans(gyro, forward, up, axle)).max())
    print(f"the filter is within {error:.3f} degrees of its equations")
    assert error < 0.1


def test_it_stands_up_only_when_asked_and_upright_and_still(robot: Robot) -> None:
    state = robot.step(1200)
    assert (state.posture, state.flags) == (BalancePosture.OFF, BalanceFlag.UPRIGHT)
    robot.sensors[2] = 512.0 - 102.0 * np.sin(np.radians(6.0))
    robot.order["may_stand"] = True
    assert robot.step(1200).posture == BalancePosture.OFF
    robot.sensors[2] = 512.0
    robot.stand()


@pytest.mark.parametrize(
    ("what", "value"),
    [
        ("readings", {"volts": 9.0}),
        ("readings", {"cord_pulled": True}),
        ("order", {"sits": True}),
        ("order", {"off": True}),
    ],
)
def test_it_does_not_stand_up_with_a_fault_or_where_it_is_asked_to_be_off(
    robot: Robot, what: str, value: dict[str, Any]
) -> None:
    getattr(robot, what).update(value)
    robot.order["may_stand"] = True
    assert all(robot.step().posture == BalancePosture.OFF for _ in range(1200))


@pytest.mark.parametrize(
    ("what", "value", "cause"),
    [("readings", {"cord_pulled": True}, "CORD"), ("order", {"off": True, "off_cause": 2}, "ESTOP_OFF")],
)
def test_the_cord_and_an_estop_off_take_the_power_in_one_period(
    robot: Robot, what: str, value: dict[str, Any], cause: str
) -> None:
    robot.stand()
    robot.sensors[:2] += 10.0
    assert any(robot.step(20).command)
    getattr(robot, what).update(value)
    robot.order["may_stand"] = True
    for _ in range(300):
        state = robot.step()
        assert (state.posture, state.cause, *state.command) == (BalancePosture.OFF, BalanceCause[cause], 0, 0)


@pytest.mark.parametrize(("side", "sign"), [(BalanceSide.FORWARD, -1), (BalanceSide.BACKWARD, 1)])
def test_it_sits_down_to_the_free_side(robot: Robot, side: BalanceSide, sign: int) -> None:
    robot.stand()
    robot.order |= {"sits": True, "free_side": side}
    state = robot.step(15)
    assert (state.posture, state.cause) == (BalancePosture.SITS_DOWN, BalanceCause.ASKED)
    assert np.sign(state.torque) == sign  # the wheels run away to the other side


@pytest.mark.parametrize(("counts", "periods"), [(30.0, 60), (np.nan, 2)])
def test_it_lets_go_before_its_caster_touches_or_where_its_lean_is_no_number(
    robot: Robot, counts: float, periods: int
) -> None:
    """Torque against the caster throws it to the other side."""
    robot.turns = [1, 1]
    robot.stand()
    robot.order |= {"sits": True, "free_side": BalanceSide.FORWARD}
    robot.step(15)
    assert robot.step().posture == BalancePosture.SITS_DOWN
    robot.sensors[:2] += counts
    state = robot.step(periods)
    assert (state.posture, state.cause, *state.command) == (BalancePosture.OFF, BalanceCause.ASKED, 0, 0)


def test_a_lean_that_is_no_number_has_fallen(robot: Robot) -> None:
    robot.stand()
    robot.sensors[0] = np.nan
    state = robot.step(2)
    assert (state.posture, state.cause, *state.command) == (BalancePosture.OFF, BalanceCause.FALLEN, 0, 0)


def test_it_does_not_wait_for_rest_or_for_its_caster_for_ever(robot: Robot) -> None:
    robot.stand()
    robot.turns = [1, 1]
    robot.order |= {"sits": True, "free_side": BalanceSide.FORWARD}
    robot.sensors[:2] += 5.0
    postures = []
    for period in range(600):
        robot.sensors[:2] += 10.0 if period % 2 else -10.0  # it shakes, and never rests
        postures.append(robot.step().posture)
    assert postures[399] == BalancePosture.SITS_DOWN
    assert postures[-1] == BalancePosture.OFF


def test_what_is_asked_while_it_sits_down_moves_nothing(robot: Robot) -> None:
    """A frame may be accepted in the period in which it begins to."""
    robot.turns = [1, 1]
    robot.stand()
    robot.order |= {"sits": True, "free_side": BalanceSide.FORWARD, "halts": False, "angular": 0.8}
    for _ in range(40):
        state = robot.step()
        assert state.posture == BalancePosture.SITS_DOWN
        assert state.command[0] == pytest.approx(state.command[1], abs=2), "it does not turn"


@pytest.mark.parametrize(
    ("what", "cause"),
    [("order", "ASKED"), ("battery", "BATTERY"), ("accelerometer", "ACCELEROMETER"), ("gyroscope", "GYROSCOPE")],
)
def test_it_is_off_where_no_side_is_free_or_it_no_longer_knows_its_lean(robot: Robot, what: str, cause: str) -> None:
    robot.stand()
    if what == "order":
        robot.order["sits"] = True
    elif what == "battery":
        robot.readings["volts"] = 9.0
    else:
        robot.sensors[3 if what == "accelerometer" else 0] = 0.0
    if what == "gyroscope":
        robot.order["free_side"] = BalanceSide.FORWARD  # it does not sit down: without its lean it cannot
    state = robot.step(30 if what == "battery" else 2)
    assert (state.posture, state.cause, *state.command) == (BalancePosture.OFF, BalanceCause[cause], 0, 0)


RATE: Final = np.array([1.0, 1.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("counts", "turns", "periods", "cause", "posture"),
    [
        (40.0 * RATE, [1, 1], 60, "FALLEN", BalancePosture.OFF),
        ([10.0, 0.0, 0.0, 0.0], [1, 1], 20, "GYROSCOPE", BalancePosture.OFF),
        (2.0 * RATE, [0, 1], 60, "LEFT_ENCODER", BalancePosture.SITS_DOWN),
        (0.0 * RATE, [0, 0], 410, "NO_WHEEL_TURNS", BalancePosture.OFF),
        (0.0 * RATE, [1, 0], 410, "RIGHT_ENCODER", BalancePosture.SITS_DOWN),
    ],
)
def test_what_is_lost_while_it_stands_ends_that(
    robot: Robot, counts: Any, turns: list[int], periods: int, cause: str, posture: BalancePosture
) -> None:
    """It sits down where it can do without what is lost."""
    robot.order["free_side"] = BalanceSide.FORWARD
    robot.stand()
    robot.turns = [1, 1]
    robot.step(20)
    robot.turns = turns
    robot.sensors += counts
    states = [(state.posture, state.cause) for state in (robot.step() for _ in range(periods))]
    assert states[0][0] == BalancePosture.STANDS
    assert states[-1] == (posture, BalanceCause[cause])


def test_a_sensor_that_flickers_stays_lost_and_the_first_cause_counts(robot: Robot) -> None:
    robot.order["free_side"] = BalanceSide.FORWARD
    robot.turns = [1, 1]
    robot.stand()
    robot.sensors[2] = 0.0
    lost = robot.step(2).accelerometer
    robot.sensors[2] = 600.0  # it is back, and wrong
    state = robot.step(30)
    assert (state.posture, state.accelerometer) == (BalancePosture.SITS_DOWN, lost)
    robot.sensors[0] = 0.0
    state = robot.step(2)
    assert (state.posture, state.cause) == (BalancePosture.OFF, BalanceCause.ACCELEROMETER)


def test_wheels_that_run_away_from_the_robot_are_in_the_air(robot: Robot) -> None:
    robot.order["free_side"] = BalanceSide.FORWARD
    robot.stand()
    state = robot.step()
    for turned in range(0, 400, 20):
        robot.readings["counts"] = [turned, turned]
        state = robot.step()
    assert (state.posture, state.cause) == (BalancePosture.OFF, BalanceCause.LIFTED)


@pytest.mark.parametrize("counts", [34.0, -34.0])
def test_an_accelerometer_that_disagrees_for_long_ends_standing(robot: Robot, counts: float) -> None:
    """Without encoders, since those would disagree with it as well."""
    robot.configure(k3=0.0, k4=0.0)
    robot.order["free_side"] = BalanceSide.FORWARD
    robot.stand()
    robot.sensors[2] += counts
    assert robot.step(40).posture == BalancePosture.STANDS
    states = [(state.posture, state.cause) for state in (robot.step() for _ in range(200))]
    assert states[-1] == (BalancePosture.OFF, BalanceCause.LEAN_DISPUTED)
    assert (BalancePosture.SITS_DOWN, BalanceCause.LEAN_DISPUTED) not in states


@pytest.mark.parametrize(("channels", "cause"), [([1], "GYROSCOPE"), ([2, 3], "ACCELEROMETER")])
def test_readings_that_no_longer_change_are_lost(robot: Robot, channels: list[int], cause: str) -> None:
    robot.stand()
    robot.noise[channels] = 0.0
    assert robot.step(14).posture == BalancePosture.STANDS
    state = robot.step(4)
    assert (state.posture, state.cause) == (BalancePosture.OFF, BalanceCause[cause])


def test_an_obstacle_holds_it_until_it_is_asked_for_nothing(robot: Robot) -> None:
    """A person whom it has met must not be pushed on."""
    robot.turns = [2, 2]
    robot.stand()
    robot.order.update(halts=False, linear=0.3)
    state = robot.step(200)  # its speed grows to 0.25 m/s, and its wheels stay where they are
    assert not state.flags & BalanceFlag.HELD
    assert any(robot.step().flags & BalanceFlag.HELD for _ in range(300))
    assert robot.step(20).flags & BalanceFlag.HELD
    robot.order["linear"] = 0.0
    assert not robot.step().flags & BalanceFlag.HELD


def test_the_torque_stays_within_that_of_the_settings(robot: Robot) -> None:
    robot.configure(torque_max=3.0, k1=7000.0)
    robot.turns = [2, 2]
    robot.stand()
    state = robot.step(20)
    assert abs(state.torque) <= 3.0
    robot.sensors[2] -= 102.0 * np.sin(np.radians(8.0))
    assert max(abs(robot.step().torque) for _ in range(40)) == pytest.approx(3.0)


@pytest.mark.parametrize("sign", [1, -1])
def test_no_command_is_rounded_beyond_the_full_one(compiled: tuple[cffi.FFI, Any], sign: int) -> None:
    """One step further it would be the full one the other way."""
    ffi, lib = compiled
    parts = {
        "model": {"settings": {"k1": 1000.0, "torque_max": 1000.0}, "volts_per_torque": 1.0},
        "kalman": {"lean": float(sign)},
        "wheel_speed": {},
        "reference": {},
        "posture": {"posture": BalancePosture.STANDS},
    }
    made = [ffi.new(f"struct {name} *", part) for name, part in parts.items()]
    torque: Any = ffi.new("struct torque *", {"rest": [sign * 0.5, sign * 0.5]})
    lib.torque_step(torque, ffi.new("struct torque_input *", [*made, 12.0]))
    assert list(torque.command) == [sign * DRIVER_FULL] * 2
