"""Cameras are asked while somebody looks, and tell why they show nothing."""

import msgspec

from giraff_core.picture.receiver import PictureReceiver
from giraff_schemas.camera import Picture
from giraff_schemas.topics import CAMERA, CAMERA_SMALL, CAMERA_STATE
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from tests.support.picture_source import Source, Sources

FULL = Picture(camera="head", jpeg=b"full", width=320, height=240, tick=None)
SMALL = msgspec.structs.replace(FULL, jpeg=b"small", width=160, height=120)
RESTARTED = Trouble("the camera has started again", "ask again")


def test_each_camera_that_is_heard_is_asked_once_as_long_as_somebody_looks() -> None:
    sources = Sources()
    pictures = PictureReceiver(sources, "ann@desk")
    assert pictures.ask_all(0.0) == []
    for name in ("head", "head", "rear"):
        state = Source(name).state
        assert state is not None
        pictures.on_sample(CAMERA_STATE, "", state, 0)
    assert pictures.ask_all(0.1) == []
    head, rear = sources.opened
    assert [(each.camera, each.by) for each in (head, rear)] == [("head", "ann@desk"), ("rear", "ann@desk")]
    head.coming = [SMALL, FULL]
    assert pictures.ask_all(0.2) == [(CAMERA_SMALL.at("head"), SMALL)]
    assert pictures.ask_all(0.3) == [(CAMERA.at("head"), FULL)]
    assert head.asked == rear.asked == ["full"] * 3
    rear.trouble = RESTARTED
    assert (pictures.trouble("rear"), pictures.trouble("head")) == (RESTARTED, NO_TROUBLE)
    assert [pictures.new_troubles() for _ in range(2)] == [["the camera has started again; ask again"], []]
    pictures.close()
    assert head.closed
    assert rear.closed


def test_one_camera_is_left_and_asked_anew_no_sooner_than_a_while_after_its_last_start() -> None:
    sources = Sources()
    pictures = PictureReceiver(sources, apart=1.0)
    for now in (0.0, 0.1):
        pictures.by = f"it at {now}"
        pictures.ask("head", now, "small")
        assert sources.opened[0].by == f"it at {now}"
    pictures.leave("head")
    pictures.leave("head")
    assert (sources.opened[0].asked, sources.opened[0].closed) == (["small"] * 2, True)
    opened = []
    for now in (0.2, 0.9, 1.1):
        pictures.ask("head", now)
        opened.append(len(sources.opened))
    assert opened == [1, 1, 2]


def test_where_nobody_may_look_nothing_comes() -> None:
    pictures = PictureReceiver(None)
    assert pictures.ask("head", 0.0) is None
    assert pictures.ask_best("head", 0.0, is_last=True) is None
    assert pictures.trouble("head") == NO_TROUBLE


def test_a_full_picture_is_waited_for_and_a_small_one_taken_where_none_comes() -> None:
    sources = Sources()
    pictures = PictureReceiver(sources)

    def best(picture: Picture | None, now: float, *, is_last: bool = False) -> Picture | None:
        pictures.ask("head", now)
        sources.opened[-1].coming = [] if picture is None else [picture]
        return pictures.ask_best("head", now, is_last=is_last)

    assert [best(SMALL, 5.0), best(FULL, 5.5), best(None, 5.6, is_last=True)] == [None, FULL, None]
    assert [best(each, now) for each, now in ((SMALL, 6.9), (None, 7.0), (None, 7.1))] == [None, SMALL, None]
    assert best(SMALL, 7.2) == SMALL  # on such a link each one counts
    pictures.leave("head")
    assert [best(SMALL, 8.0), best(None, 8.1, is_last=True)] == [None, SMALL]
