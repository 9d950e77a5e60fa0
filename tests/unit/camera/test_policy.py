"""Who sees a camera's pictures, how long, and what they take of a link."""

import pytest

from giraff_camera.policy import LATE, MOST_ASKERS, MOST_ON_THE_WAY, PicturePolicy
from giraff_core.picture.asker import PictureAsker
from giraff_schemas.camera import HOLD_ENDS, CameraHold, CameraState, Picture
from giraff_schemas.codec import encode, stamped
from tests.unit.camera.looking import FULL, Link, Scene

NOTHING = Picture(camera="head", jpeg=b"", width=160, height=120, tick=None)
FAST = Link(rate=100e6, delay=0.001)


def hold(instance: str = "me", to: str = "camera", state: int = 0, camera: str = "head", by: str = "me") -> CameraHold:
    return CameraHold(camera=camera, to=to, state=state, by=by, size="small", instance=instance)


def shown(policy: PicturePolicy) -> list[str]:
    return [asker.instance for asker in policy.askers()]


def test_nobody_is_shown_a_picture_unasked() -> None:
    scene = Scene(FAST, until=0.0)
    scene.run(3.0)
    assert not shown(scene.policy)
    assert scene.sent == {"full": 0, "small": 0}


@pytest.mark.parametrize("link", [FAST, Link(rate=1e6, delay=0.02), Link(rate=30e3, delay=0.4)])
def test_no_picture_is_sent_two_seconds_after_the_last_one_has_let_go(link: Link) -> None:
    scene = Scene(link, until=5.0)
    scene.run(6.0 + HOLD_ENDS)
    sent = sum(scene.sent.values())
    assert sent > 2
    assert not shown(scene.policy)
    scene.run(5.0)
    assert sum(scene.sent.values()) == sent


def test_a_camera_that_has_started_again_shows_nothing_to_those_who_still_look() -> None:
    scene = Scene(FAST)
    scene.run(3.0)
    assert shown(scene.policy)
    scene.start("another")
    scene.run(5.0)
    assert not shown(scene.policy)
    assert scene.sent == {"full": 0, "small": 0}
    assert "ask for its picture again" in scene.viewers[0].asker.trouble(scene.now).remedy


def test_who_has_slept_does_not_look_again_by_itself() -> None:
    scene = Scene(FAST)
    scene.run(3.0)
    scene.viewers[0].sleeps = True
    scene.run(HOLD_ENDS + 1.0)
    scene.viewers[0].sleeps = False
    scene.run(3.0)
    assert not shown(scene.policy)
    assert "ask for its picture again" in scene.viewers[0].asker.trouble(scene.now).remedy


def test_a_word_that_comes_once_more_counts_once() -> None:
    policy = PicturePolicy("head", "camera", 15.0, 40_000)
    policy.on_state_sent(0, 0.0)
    policy.on_hold(stamped(hold(), 7, 0, "me"), 0.1)
    policy.on_state_sent(1, 1.5)
    policy.on_hold(stamped(hold(state=1), 7, 0, "me"), 1.6)
    policy.update(HOLD_ENDS)
    assert not shown(policy)


def test_pictures_that_others_alone_have_asked_for_are_not_taken() -> None:
    asker = PictureAsker("head", "me")
    asker.want("full", 0.0)
    assert not asker.takes(stamped(NOTHING, 0, 0, "camera"), "small"), "before it has heard the camera"
    state = CameraState(camera="head", askers=(), width=320, height=240, rate=0.0)
    assert asker.on_state(stamped(state, 0, 0, "camera"), "me", 0.1) is not None
    assert asker.on_picture(stamped(NOTHING, 0, 0, "another start"), "small", 0.2) is None
    assert asker.on_picture(stamped(NOTHING, 0, 0, "camera"), "small", 0.2) is not None
    asker.want("full", 9.0)
    assert not asker.takes(stamped(NOTHING, 0, 0, "camera"), "small"), "after it has slept"


def test_a_late_word_turns_nothing_on() -> None:
    policy = PicturePolicy("head", "camera", 15.0, 40_000)
    policy.on_state_sent(0, 0.0)
    policy.on_hold(hold(), HOLD_ENDS + 0.01)
    policy.on_hold(hold(state=7), 1.0)  # one that was never said
    policy.on_hold(hold(camera="rear"), 1.0)
    policy.on_hold(hold(to="the camera before its restart"), 1.0)
    assert not shown(policy)
    policy.on_hold(hold(), 1.0)
    policy.update(1.0)
    assert shown(policy) == ["me"]
    policy.update(HOLD_ENDS)  # counted from the state that it has answered
    assert not shown(policy)


def test_no_more_look_than_a_camera_can_serve() -> None:
    policy = PicturePolicy("head", "camera", 15.0, 40_000)
    policy.on_state_sent(0, 0.0)
    for n in range(MOST_ASKERS + 5):
        policy.on_hold(hold(str(n)), 0.1)
    assert shown(policy) == [str(n) for n in range(MOST_ASKERS)]


@pytest.mark.parametrize(
    ("by", "told"), [("", "somebody without a name"), (" ", "somebody without a name"), ("a\nb", "a?b")]
)
def test_nobody_looks_without_a_name(by: str, told: str) -> None:
    policy = PicturePolicy("head", "camera", 15.0, 40_000)
    policy.on_state_sent(0, 0.0)
    policy.on_hold(hold(by=by), 0.1)
    assert [asker.by for asker in policy.askers()] == [told]


def test_no_name_is_so_long_that_the_state_reaches_nobody() -> None:
    policy = PicturePolicy("head", "camera", 15.0, 40_000)
    policy.on_state_sent(0, 0.0)
    policy.on_hold(hold("i" * 60_000), 0.1)
    for n in range(MOST_ASKERS):
        policy.on_hold(hold(f"{n:064}", by="\N{ROBOT FACE}" * 60_000), 0.1)
    assert len(policy.askers()) == MOST_ASKERS
    state = CameraState(camera="head", askers=policy.askers(), width=320, height=240, rate=15.0)
    assert len(encode(stamped(state, 0, 0, "camera"))) < 20_000


@pytest.mark.parametrize(
    ("link", "size", "most"),
    [
        (FAST, "full", 15.0),
        (Link(rate=1e6, delay=0.02), "small", 12.0),
        (Link(rate=200e3, delay=0.02), "small", 7.0),
    ],
)
def test_a_picture_takes_a_small_part_of_the_link_and_leaves_it_as_much(link: Link, size: str, most: float) -> None:
    scene = Scene(link)
    scene.run(20.0)
    late = [each for each in scene.viewers[0].came if each.at > 5.0]
    assert {each.size for each in late} == {size}
    assert most / 2 <= len(late) / 15.0 <= most + 0.5
    assert max(each.on_the_way for each in late) <= MOST_ON_THE_WAY + 0.005
    assert sum(each.on_the_way for each in late) <= 15.0 * 0.55


def test_a_slow_link_slows_those_alone_that_have_one() -> None:
    scene = Scene(FAST, Link(rate=60e3, delay=0.1), *[FAST] * 18)
    scene.run(20.0)
    counts = [sum(each.at > 5.0 for each in viewer.came) / 15.0 for viewer in scene.viewers]
    assert min(counts[:1] + counts[2:]) > 14.0
    assert 1.0 < counts[1] < 5.0
    assert [asker.size for asker in scene.policy.askers()].count("small") == 1


def test_one_that_says_nothing_of_its_pictures_holds_up_the_others_for_a_moment() -> None:
    scene = Scene(FAST, FAST)
    scene.run(5.0)
    mute = scene.viewers[1]
    mute.confirms = False
    scene.run(LATE + 1.0)
    assert [asker.is_late for asker in scene.policy.askers()] == [False, True]
    before = len(scene.viewers[0].came)
    scene.run(5.0)
    assert len(scene.viewers[0].came) - before > 70


def test_who_wants_the_small_picture_gets_it_over_any_link() -> None:
    scene = Scene(FAST)
    scene.viewers[0].largest = "small"
    scene.run(5.0)
    assert {each.size for each in scene.viewers[0].came} == {"small"}
    assert max(each.bytes for each in scene.viewers[0].came) < FULL
