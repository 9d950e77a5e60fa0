"""What an operator's side may take for a stop."""

import msgspec
import pytest

from giraff_core.estop.latch import is_confirmed_stop
from giraff_core.estop.request import StopConfirmation
from giraff_schemas.messages import EStop
from giraff_schemas.requests import EStopAnswer
from giraff_schemas.trouble import Trouble
from tests.unit.node.test_repeating import Request

DONE = EStopAnswer(done=True, engaged=True, id=4, instance="base-1")
OWN = EStop(instance="base-1", engaged=True, id=4, by="me", reason=Trouble("a cat"))


@pytest.mark.parametrize("done", [False, True])
@pytest.mark.parametrize("engaged", [False, True])
def test_only_what_is_done_and_engaged_stops_for_good(done: bool, engaged: bool) -> None:
    assert is_confirmed_stop(EStopAnswer(done=done, engaged=engaged, id=4)) is (done and engaged)


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        ({}, None),
        ({}, {"instance": "another"}),
        ({}, {"id": 3}),
        ({}, {"engaged": False}),
        ({"instance": ""}, {}),
        ({"instance": "another"}, {}),
        ({"id": 5}, {}),
        ({"done": False, "reason": Trouble("disk full")}, None),
    ],
    ids=str,
)
def test_an_answer_counts_only_beside_bases_own_word_of_that_latch(
    answer: dict[str, object], told: dict[str, object] | None
) -> None:
    confirmation = StopConfirmation()
    asking = Request(confirmation.judge)
    if told is not None:
        confirmation.on_sample(msgspec.structs.replace(OWN, **told))
    asking.on_answer(msgspec.structs.replace(DONE, **answer))
    assert asking.poll(0.0) is None
    assert (asking.refusal, "no estop sample of" in asking.fault) == (None, True)


def test_bases_own_word_may_come_after_its_answer_and_a_full_disk_is_told() -> None:
    confirmation = StopConfirmation()
    asking = Request(confirmation.judge)
    full = msgspec.structs.replace(DONE, done=False, reason=Trouble("disk full"))
    for answer in (DONE, full):
        asking.on_answer(answer)
    assert asking.poll(0.0) is None
    confirmation.on_sample(OWN)
    assert [asking.poll(0.01), asking.poll(0.02)] == [DONE, DONE]
    assert asking.sent == 1
    assert confirmation.judge(full) is False
    confirmation.on_sample(msgspec.structs.replace(OWN, engaged=False))
    assert isinstance(confirmation.judge(DONE), str), "it was released since"


@pytest.mark.parametrize(("done", "settles"), [(True, True), (False, False)])
def test_each_live_base_of_the_name_must_confirm(done: bool, settles: bool) -> None:
    confirmation = StopConfirmation("anna")
    confirmation.on_base("base-1", present=True)
    confirmation.on_sample(OWN)
    assert (confirmation.judge(DONE), confirmation.unconfirmed()) == (True, "")
    other = msgspec.structs.replace(DONE, instance="other", done=done)
    confirmation.on_base("other", present=True)
    told = str(confirmation.judge(DONE))
    assert told.startswith("2 bases are called anna; only base-1 confirmed; end all but one")
    assert told == confirmation.unconfirmed()
    assert isinstance(confirmation.judge(other), str), "no estop sample of its own"
    confirmation.on_sample(msgspec.structs.replace(OWN, instance="other"))
    assert confirmation.judge(other) is settles
    assert (confirmation.judge(DONE) is True) is settles, "what the other cannot keep over a restart is not confirmed"
    assert confirmation.unconfirmed() == ""
    confirmation.judge(msgspec.structs.replace(other, engaged=False))
    assert isinstance(confirmation.judge(DONE), str), "the other was released"
    confirmation.on_base("other", present=False)
    assert confirmation.judge(DONE) is True, "a token that went counts no more"


def test_a_flood_of_strangers_words_fills_nothing() -> None:
    confirmation = StopConfirmation()
    for number in range(10_000):
        confirmation.on_sample(msgspec.structs.replace(OWN, instance=str(number)))
    confirmation.on_sample(OWN)
    assert confirmation.judge(DONE) is True
    assert len(vars(confirmation)["_stated"]) <= 16
