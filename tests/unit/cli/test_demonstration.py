"""When the hand of a demonstration is flat, by what it hears alone."""

import pytest

from giraff_cli.run.demonstration import ASKS, DRIVES, FLAT, QUIET, SETTLES, WARNING, Demonstration
from giraff_core.lease import ASK
from giraff_core.operator import ASKS_NOTHING
from giraff_schemas.messages import DriveCommand, EStop, Lease, Sample, Source
from giraff_schemas.services import DEMONSTRATION
from tests.unit.cli.samples import estop

LOOK = 0.2


def says(linear: float, *, counter: int = 7, operator: str = "ann", source: Source = "hand") -> DriveCommand:
    return DriveCommand(
        operator=operator, lease_counter=counter, linear_x=linear, angular_z=0.0, source=source, tick=None
    )


def lease(operator: str) -> Lease:
    return Lease(holder="x" if operator else "", operator=operator, counter=1)


@pytest.fixture
def demonstration() -> Demonstration:
    """One that drives."""
    made = Demonstration()
    made.on_sample(lease(DEMONSTRATION), 0.0)
    assert made.grip(0.0) == DRIVES
    return made


def drives_at(demonstration: Demonstration, since: float, until: float) -> float | None:
    """The first moment at which the hand tilts again; the guard gives the lease to whoever asks."""
    for look in range(round((until - since) / LOOK)):
        now = since + look * LOOK
        grip = demonstration.grip(now)
        if grip == DRIVES:
            return now
        if grip == ASKS:
            demonstration.on_sample(lease(DEMONSTRATION), now)
    return None


@pytest.mark.parametrize(
    "sample",
    [says(0.1), says(0.0, counter=ASK), lease("ann"), estop(engaged=True)],
    ids=["drives", "asks", "has it", "stop"],
)
def test_it_lets_go_at_once(demonstration: Demonstration, sample: Sample) -> None:
    demonstration.on_sample(sample, 1.0)
    assert demonstration.grip(1.0) == FLAT
    assert demonstration.note


@pytest.mark.parametrize(
    "sample",
    [
        says(0.0, counter=ASKS_NOTHING),
        says(0.0),
        says(0.0, counter=ASK, source="fault"),
        says(0.4, operator=DEMONSTRATION),
        lease(DEMONSTRATION),
        lease(""),
        estop(),
    ],
    ids=["runs", "rests", "fault", "own", "own lease", "no lease", "no stop"],
)
def test_what_asks_for_nothing_is_no_reason(demonstration: Demonstration, sample: Sample) -> None:
    demonstration.on_sample(sample, 1.0)
    assert demonstration.grip(1.0) == DRIVES


def test_it_drives_again_after_30_s_of_quiet_and_says_so_before(demonstration: Demonstration) -> None:
    demonstration.on_sample(says(0.2), 1.0)
    demonstration.on_sample(says(0.2), 3.0)
    assert drives_at(demonstration, 3.0, 3.0 + QUIET - WARNING) is None
    assert "ann drives; the demonstration waits" in demonstration.note
    demonstration.grip(3.0 + QUIET - WARNING)
    assert "drives on in 3 s" in demonstration.note
    drives = drives_at(demonstration, 3.0 + QUIET - WARNING, 60.0)
    assert drives is not None
    assert 0.0 <= drives - (3.0 + QUIET + SETTLES) < 3 * LOOK
    assert not demonstration.note


@pytest.mark.parametrize("at", [10.0, QUIET - 0.5, QUIET + 1.4])
def test_whatever_comes_meanwhile_begins_the_wait_anew(demonstration: Demonstration, at: float) -> None:
    """While it waits, warns, and settles."""
    demonstration.on_sample(says(0.2), 1.0)
    assert drives_at(demonstration, 1.0, at) is None
    demonstration.on_sample(says(0.2), at)
    assert demonstration.grip(at) == FLAT
    drives = drives_at(demonstration, at, at + 60.0)
    assert drives is not None
    assert drives - at >= QUIET


def test_a_stop_holds_it_for_as_long_as_it_is_engaged_and_its_reset_for_30_s(demonstration: Demonstration) -> None:
    for second in range(120):
        if second < 60:  # then base is silent: the stop is engaged, as far as anybody knows
            demonstration.on_sample(estop(engaged=True), float(second))
        assert demonstration.grip(float(second)) == FLAT
    assert "`giraff estop reset`" in demonstration.note
    released: EStop = estop()
    demonstration.on_sample(released, 120.0)
    demonstration.on_sample(released, 140.0)  # base says so twice a second
    drives = drives_at(demonstration, 120.0, 200.0)
    assert drives is not None
    assert 120.0 + QUIET <= drives < 120.0 + QUIET + 2.0


def test_at_the_end_of_the_run_it_is_flat_for_good(demonstration: Demonstration) -> None:
    demonstration.end()
    demonstration.on_sample(says(0.2), 1.0)
    assert drives_at(demonstration, 0.0, 100.0) is None
    assert not demonstration.note


def test_a_lease_that_ends_before_it_tilts_is_asked_for_again(demonstration: Demonstration) -> None:
    demonstration.on_sample(says(0.2), 0.0)
    demonstration.on_sample(lease(DEMONSTRATION), 0.0)  # its old one, which nobody has taken
    demonstration.grip(QUIET - WARNING)
    assert demonstration.grip(QUIET) == ASKS
    assert demonstration.grip(QUIET + LOOK) == FLAT
    demonstration.on_sample(lease(""), QUIET + LOOK)
    assert demonstration.grip(QUIET + 2 * LOOK) == ASKS
