"""What a host of the balancing robot's board has to know before the robot moves, and what it may change."""

import pytest

from giraff_schemas.boards import BALANCER_BOARD
from giraff_schemas.wire import DriveState, Refusal, Wiring
from giraff_schemas.wires.balancer import BalanceAsk, BalanceEngage, BalanceFlag, BalancePosture, BalanceSide
from giraff_sim.board import Implementation, open_board
from tests.firmware.balancing import BalancerBench
from tests.firmware.builds import compiled


@pytest.mark.parametrize("what", ["session", "release"])
def test_what_a_host_knew_before_a_new_session_or_a_release_counts_no_more(what: str) -> None:
    board = BalancerBench(open_board(BALANCER_BOARD, Implementation.HOST, compiled()))
    board.configure()
    board.drive(milliseconds=1600)
    assert board.report().flags & BalanceFlag.UPRIGHT
    if what == "session":
        board.configure(session=8)
    else:
        board.estop(BalanceEngage.STANDS)
        board.estop(BalanceEngage.RELEASE)
    board.drive(milliseconds=100, ask=BalanceAsk.STAND)
    assert (board.report().posture, board.report().drive_state) == (BalancePosture.OFF, DriveState.ACTIVE)
    board.get_up()
    board.board.close()


def test_the_wiring_of_a_robot_that_stands_is_not_changed_under_it() -> None:
    """With a motor turned round it would throw itself over."""
    board = BalancerBench(open_board(BALANCER_BOARD, Implementation.HOST, compiled()))
    board.stand()
    board.configure(session=8, wiring=int(Wiring.INVERT_LEFT_MOTOR))
    report = board.report()
    assert (report.session, report.last_refusal, report.posture) == (7, Refusal.PROTOCOL, BalancePosture.STANDS)
    board.board.close()


@pytest.mark.parametrize(
    ("free", "ends"), [(BalanceSide.NONE, BalancePosture.OFF), (BalanceSide.FORWARD, BalancePosture.SITS_DOWN)]
)
def test_what_went_off_or_sits_down_waits_for_a_zero(free: BalanceSide, ends: BalancePosture) -> None:
    """Its host drives, and has not heard of it yet."""
    board = BalancerBench(open_board(BALANCER_BOARD, Implementation.HOST, compiled()))
    board.stand()
    board.drive(0.1, free_side=free)
    board.battery = 9.5
    while board.report().posture == BalancePosture.STANDS:
        board.drive(0.1, ask=BalanceAsk.STAND, free_side=free)
    assert (board.report().posture, board.report().drive_state) == (ends, DriveState.AWAITING_ZERO)
    board.board.close()
