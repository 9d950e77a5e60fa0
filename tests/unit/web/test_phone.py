"""A phone as the joystick: at any rate of its browser, either sign of gravity, and any orientation of its screen."""

import pytest

from giraff_schemas.trouble import NO_TROUBLE
from tests.unit.web.hands import PhonePerson

RATES = [10.0, 16.0, 60.0, 100.0, 200.0]


def held(hertz: float = 60.0, forward: float = 0.0, left: float = 0.0, **fields: float) -> PhonePerson:
    """The finger has come down on a phone that was held so."""
    person = PhonePerson(hertz, sign=fields.get("sign", 1.0), angle=int(fields.get("angle", 0)))
    person.keep(1.0, forward, left)
    person.put_down()
    person.keep(0.4, forward, left)
    return person


@pytest.mark.parametrize("hertz", RATES)
@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["standard", "webkit"])
@pytest.mark.parametrize("angle", [0, 90, 180, 270])
def test_forward_is_forward_and_left_is_left(hertz: float, sign: float, angle: int) -> None:
    person = held(hertz, sign=sign, angle=angle)
    assert (person.is_holding(), person.hand.asks, person.hand.lost) == (True, (0.0, 0.0), NO_TROUBLE)
    person.keep(0.2, forward=21.5)
    assert person.hand.asks == pytest.approx((0.3, 0.0), abs=0.02)
    person.keep(0.2, forward=-21.5)
    assert person.hand.asks == pytest.approx((-0.3, 0.0), abs=0.02)
    person.keep(0.2, left=21.5)
    assert person.hand.asks == pytest.approx((0.0, 0.785), abs=0.05)
    person.keep(0.2, left=-21.5)
    assert person.hand.asks == pytest.approx((0.0, -0.785), abs=0.05)


@pytest.mark.parametrize("zero", [-30.0, 20.0, 40.0])
def test_where_the_finger_comes_down_is_the_zero(zero: float) -> None:
    person = held(forward=zero)
    assert person.hand.asks == (0.0, 0.0)
    person.keep(0.2, forward=zero + 30.0)
    assert person.hand.asks[0] > 0.3
    person.let_go()
    person.keep(0.5, forward=0.0)
    person.put_down()
    person.keep(0.4, forward=0.0)
    assert (person.is_holding(), person.hand.asks) == (True, (0.0, 0.0))


def test_nothing_is_asked_without_a_finger() -> None:
    person = PhonePerson()
    person.keep(1.0)
    person.keep(1.0, forward=30.0)
    assert (person.is_holding(), person.hand.asks) == (False, (0.0, 0.0))


@pytest.mark.parametrize("forward", [50.0, 80.0])
def test_beyond_45_degrees_is_no_zero(forward: float) -> None:
    person = held(forward=forward)
    assert not person.is_holding()
    assert "45 degrees" in str(person.hand.lost)


def test_a_phone_that_moves_gets_no_zero() -> None:
    person = PhonePerson()
    person.keep(0.4)
    person.keep(0.1, forward=15.0)
    person.put_down()
    person.keep(0.3, forward=15.0)
    assert not person.is_holding()
    assert "moved" in str(person.hand.lost)


def test_a_finger_that_was_never_off_has_no_zero() -> None:
    """Also one that was lifted for less than two readings."""
    person = PhonePerson()
    person.put_down()
    person.keep(1.0)
    assert not person.is_holding()
    person = held()
    person.put_down()
    person.keep(0.3)
    assert not person.is_holding()


@pytest.mark.parametrize("hertz", RATES)
def test_a_fall_ends_the_hold(hertz: float) -> None:
    person = held(hertz)
    person.read += 1
    person.wish(1 / hertz, input="tilt", readings=((person.read / hertz, 0.0, 0.1, 0.2),))
    assert not person.is_holding()
    assert "the phone is falling" in str(person.hand.lost)
    person.keep(1.0, forward=20.0)
    assert not person.is_holding(), "the finger was not lifted"


def test_a_shake_ends_the_hold() -> None:
    person = held()
    for n in range(12):
        person.read += 1
        x = 15.0 * (-1) ** (n // 2)
        person.wish(input="tilt", readings=((person.read / 60.0, x, 0.0, 9.8),))
    assert not person.is_holding()
    assert "shaken" in str(person.hand.lost)


def test_a_sensor_that_has_gone_silent_ends_the_hold() -> None:
    person = held()
    for _ in range(17):
        person.wish(input="tilt")
    assert person.is_holding()
    for _ in range(3):
        person.wish(input="tilt")
    assert not person.is_holding()
    assert "sensor" in str(person.hand.lost)


def test_a_gap_in_the_readings_ends_the_hold() -> None:
    person = held()
    person.read += 60
    person.keep(0.1)
    assert not person.is_holding()


def test_a_screen_that_turns_ends_the_hold() -> None:
    person = held()
    person.angle = 90
    person.keep(0.1)
    assert not person.is_holding()


def test_readings_that_come_again_are_read_once() -> None:
    person = held()
    person.read -= 30
    person.keep(0.2, forward=30.0)
    assert person.hand.asks == (0.0, 0.0)


def test_time_that_hardly_goes_on_fills_no_memory() -> None:
    person = held()
    began = person.read / person.hertz
    for n in range(50):
        readings = tuple((began + (40 * n + k) * 1e-6, 0.0, 0.0, 9.8) for k in range(40))
        person.wish(0.004, input="tilt", readings=readings)
    assert len(person.hand._phone._clutch._recent) < 100
