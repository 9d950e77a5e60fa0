"""What an operator's side may take for a stop."""

import pytest

from giraff_core.estop import stops_for_good
from giraff_schemas.messages import EStopAnswer


@pytest.mark.parametrize("done", [False, True])
@pytest.mark.parametrize("engaged", [False, True])
def test_only_what_is_done_and_engaged_stops_for_good(done: bool, engaged: bool) -> None:
    assert stops_for_good(EStopAnswer(done=done, engaged=engaged, id=4, reason="")) is (done and engaged)
