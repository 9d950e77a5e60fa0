"""A robot that balances is driven by a hand. tests/campaign/test_balancer.py has the drawn ones."""

from tests.loop.balancer import against_wall, no_other_margin, tour
from tests.loop.loops import closed_loop
from tests.sim.robots import proving_room
from tests.support.balancer_file import BALANCER, SIM


def test_it_drives_round_the_furnished_room() -> None:
    drive = tour(1, 8.0)
    assert (drive.contacts, drive.falls) == (0, 0)
    assert drive.path > 1.0
    assert drive.fastest < 0.45


def test_its_run_on_alone_keeps_it_off_a_wall() -> None:
    drive = against_wall(3, 1.5, no_other_margin())
    assert (drive.contacts, drive.falls) == (0, 0)
    assert drive.path > 0.8
    assert drive.closest > 0.05


def test_its_black_box_has_the_reports_of_its_board() -> None:
    with closed_loop(proving_room(), BALANCER, sim=SIM, step_us=1000) as loop:
        loop.run(0.5)
        record = loop.simulation.record.window(0, loop.simulation.now_us)
    assert 45 <= record.telemetry <= 50
    assert record.accepted > 20
