"""What an operator's side may take for a stop."""

import pytest

from giraff_core.estop import is_confirmed_stop
from giraff_schemas.requests import EStopAnswer


@pytest.mark.parametrize("done", [False, True])
@pytest.mark.parametrize("engaged", [False, True])
def test_only_what_is_done_and_engaged_stops_for_good(done: bool, engaged: bool) -> None:
    assert is_confirmed_stop(EStopAnswer(done=done, engaged=engaged, id=4, reason="")) is (done and engaged)
