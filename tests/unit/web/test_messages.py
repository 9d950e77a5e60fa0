"""What a page may say: nothing that is out of bounds gets in, and nothing that gets in ends the service."""

import math

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_web.config import WebConfig
from giraff_web.hand import PageHand
from giraff_web.messages import FromPage, LetGo, PageWish
from tests.support.robots import ROBOT
from tests.unit.web.hands import Person

_decoder = msgspec.json.Decoder(FromPage)
_WISH = '{"type":"wish","n":1,"tick":null,"hold":0,"input":"tilt"%s}'


@pytest.mark.parametrize(
    "text",
    [
        "",
        "null",
        "[]",
        '{"type":"wish"}',
        '{"type":"drive","n":1}',
        '{"type":"seen","n":-1}',
        '{"type":"look","on":1}',
        '{"type":"picture_seen","n":4294967296}',
        '{"type":"seen","n":9007199254740993}',
        '{"type":"let_go","n":1,"why":"bored"}',
        '{"type":"reset","id":"99999999999999999999","engaged_ns":"0","tick":null}',
        '{"type":"reset","id":"1","engaged_ns":"9223372036854775808","tick":null}',
        '{"type":"reset","id":"1\\n","engaged_ns":"0","tick":null}',
        '{"type":"reset","id":"-1","engaged_ns":"0","tick":null}',
        '{"type":"stop","by":"me"}',
        '{"type":"go","n":1,"tick":null,"goal":"kitchen"}',
        '{"type":"go","n":1,"tick":["1","1"],"goal":""}',
        '{"type":"go","n":1,"tick":["1","1"],"goal":[1e999,0]}',
        '{"type":"go","n":1,"tick":["1","1"],"goal":[0,10001]}',
        _WISH % ',"forward":1.01',
        _WISH % ',"forward":NaN',
        _WISH % ',"left":-1e999',
        _WISH % ',"angle":45',
        _WISH % ',"readings":[[0,0,0]]',
        _WISH % ',"readings":[[0,1e999,0,0]]',
        _WISH % ',"readings":[[0,20000,0,0]]',
        _WISH % ',"readings":[[-1,0,0,9.8]]',
        _WISH % f',"readings":{[[0, 0, 0, 9.8]] * 41}',
        '{"type":"wish","n":1,"tick":["1","-1"],"hold":0,"input":"pad"}',
        '{"type":"wish","n":1,"tick":["1","\u0663"],"hold":0,"input":"pad"}',
        '{"type":"wish","n":1,"tick":["1"],"hold":0,"input":"pad"}',
    ],
)
def test_what_is_out_of_bounds_is_no_message(text: str) -> None:
    with pytest.raises(msgspec.MsgspecError):
        _decoder.decode(text)


_DIGITS = st.one_of(st.sampled_from(["7", "0", "9" * 20]), st.from_regex("[0-9]{1,20}", fullmatch=True))
_ACCELERATIONS = st.floats(-1e4, 1e4)
_NUMBERS = st.integers(0, 30)
_READINGS = st.tuples(st.floats(0.0, 10.0), _ACCELERATIONS, _ACCELERATIONS, _ACCELERATIONS)
_WISHES = st.builds(
    PageWish,
    n=_NUMBERS,
    tick=st.one_of(st.none(), st.tuples(_DIGITS, _DIGITS), st.just(("7", "1000000000"))),
    hold=st.integers(0, 4),
    input=st.sampled_from(["tilt", "pad", "keys", "gamepad"]),
    forward=st.sampled_from([0.0, 1.0, -1.0, 0.3]),
    left=st.sampled_from([0.0, 1.0, -1.0]),
    readings=st.lists(_READINGS, max_size=12).map(tuple),
    angle=st.sampled_from([0, 90, 180, 270]),
)
_ENDS = st.builds(LetGo, n=_NUMBERS, why=st.sampled_from(["finger", "hidden", "left"]))


@given(st.lists(st.tuples(st.one_of(_WISHES, _ENDS), st.floats(0.0, 0.5)), max_size=30))
def test_whatever_a_page_says_the_hand_asks_for_what_the_wheels_can(said: list[tuple[PageWish | LetGo, float]]) -> None:
    hand, now, newest = PageHand(WebConfig(), ROBOT), 0.0, Person().tick
    for message, after in said:
        now += after
        if isinstance(message, PageWish):
            hand.on_wish(message, newest, now)
        else:
            hand.on_let_go(message)
        linear, angular = hand.asks
        assert math.isfinite(linear)
        assert abs(linear) + abs(angular) * ROBOT.track_width / 2.0 <= ROBOT.max_wheel_speed + 1e-9
        assert hand.holds or (linear, angular) == (0.0, 0.0)
