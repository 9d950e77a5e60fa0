"""A request is repeated until it is answered, at moments that its owner gives."""

from collections.abc import Callable

from giraff_core.retry import RetriedRequest
from giraff_schemas.requests import EStopAnswer
from giraff_schemas.trouble import Trouble

NO = EStopAnswer(done=False, engaged=False, id=0, reason=Trouble("no"))
YES = EStopAnswer(done=True, engaged=True, id=1)
LATER = EStopAnswer(done=True, engaged=True, id=2)


class Request(RetriedRequest[EStopAnswer]):
    """To nobody yet; settled by what is done."""

    def __init__(self, settles: Callable[[EStopAnswer], bool | str] = lambda answer: answer.done) -> None:
        super().__init__(settles)
        self.sent = 0

    def _attempt(self) -> None:
        self.sent += 1


def test_a_request_to_nobody_is_repeated() -> None:
    asking = Request()
    assert asking.poll(0.0) is None
    assert asking.poll(0.1) is None
    assert (asking.attempts, asking.sent) == (1, 1)
    assert asking.poll(0.3) is None
    assert (asking.attempts, asking.sent) == (2, 2)


def test_an_answer_that_does_not_settle_it_is_kept_and_asking_goes_on() -> None:
    asking = Request()
    asking.poll(0.0)
    asking.on_answer(NO)
    assert asking.poll(0.1) is None
    assert asking.refusal == NO
    assert asking.poll(0.3) is None
    assert asking.sent == 2


def test_the_first_answer_that_settles_it_ends_it() -> None:
    asking = Request()
    asking.poll(0.0)
    for answer in (NO, YES, LATER):
        asking.on_answer(answer)
    assert [asking.poll(0.1), asking.poll(5.0)] == [YES, YES]
    assert asking.sent == 1
