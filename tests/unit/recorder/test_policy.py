"""The flight recorder: what it remembers, what is an incident, which files go."""

from functools import cache
from itertools import pairwise
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_mcap.raw_sample import RawSample
from giraff_recorder.config import RecorderConfig
from giraff_recorder.policy import Incident, IncidentDetector, IncidentFile, Memory, surplus
from giraff_schemas.health import Health
from giraff_schemas.messages import BaseState, EStop
from giraff_schemas.trouble import Trouble
from tests.unit.cli import samples
from tests.unit.cli.samples import estop

CONFIG = RecorderConfig()


def base(*, armed: bool = True, **board: Any) -> BaseState:
    sample = samples.base(armed=armed, reason="no word")
    return msgspec.structs.replace(sample, board=msgspec.structs.replace(sample.board, **board))


def health(*faults: str) -> Health:
    return Health(
        service="guard", instance="i", host="h", pid=1, uptime=1.0, ok=not faults, faults=tuple(map(Trouble, faults))
    )


@pytest.mark.parametrize("hear", ["estop", "base", "health"])
def test_a_text_of_others_is_cut(hear: str) -> None:
    long = "x\n" * 30_000
    incidents = IncidentDetector(CONFIG)
    for bad in (False, True):
        if hear == "estop":
            incidents.on_estop(EStop(engaged=bad, id=1, by=long, reason=Trouble(long)), 1.0)
        elif hear == "base":
            incidents.on_base(msgspec.structs.replace(base(connected=not bad), reason=Trouble(long)), 1.0)
        else:
            incidents.on_health(health(*[long] * bad), 1.0)
    incident = incidents.due(100.0)
    assert incident is not None
    assert len(incident.text) <= 1000
    assert incident.text.isprintable()


def test_nobody_adds_services_that_there_are_not() -> None:
    incidents = IncidentDetector(CONFIG)
    for number in range(1000):
        for faults in ((), ("bad",)):
            incidents.on_health(msgspec.structs.replace(health(*faults), service=f"s{number}"), 1.0)
    assert incidents.due(100.0) is None


def first_due(incidents: IncidentDetector, begin: float, end: float) -> tuple[float, Incident]:
    """When an incident is due, to 0.1 s."""
    now = begin
    while (incident := incidents.due(now)) is None:
        now += 0.1
        assert now < end
    return now, incident


def test_an_emergency_stop_is_written_with_the_minute_before_and_what_follows() -> None:
    incidents = IncidentDetector(CONFIG)
    incidents.on_estop(estop(engaged=False), 100.0)
    incidents.on_estop(estop(engaged=True), 200.0)
    at, incident = first_due(incidents, 200.0, 300.0)
    assert at == pytest.approx(205.0, abs=0.2)
    assert incident == Incident("estop", "emergency stop by ann@desk: smoke", 140_000_000_000)
    incidents.on_estop(estop(engaged=True), 206.0)
    assert incidents.due(1000.0) is None


def test_a_stop_that_was_there_before_is_none() -> None:
    incidents = IncidentDetector(CONFIG)
    for now in (1.0, 2.0):
        incidents.on_estop(estop(engaged=True), now)
    assert incidents.due(100.0) is None


def test_what_repeats_itself_fills_one_file_a_minute_and_misses_no_second() -> None:
    incidents = IncidentDetector(CONFIG)
    files = []
    for tenth in range(10_000):
        now = 1000.0 + tenth / 10.0
        incidents.on_estop(estop(engaged=tenth // 10 % 2 == 1), now)
        if (incident := incidents.due(now)) is not None:
            files.append((incident.since_ns * 1e-9, now))
    assert len(files) == pytest.approx(1000.0 / 60.0, abs=1.5)
    for (_, ended), (began, _) in pairwise(files):
        assert began == pytest.approx(ended)


@pytest.mark.parametrize(
    ("board", "kind"),
    [({"latch": "left_stuck"}, "board"), ({"connected": False}, "board"), ({"latch": "estop"}, None), ({}, None)],
)
def test_a_fault_of_the_base_board_is_one(board: dict[str, Any], kind: str | None) -> None:
    incidents = IncidentDetector(CONFIG)
    incidents.on_base(base(), 1.0)
    incidents.on_base(base(**board), 2.0)
    incident = incidents.due(100.0)
    assert (incident.kind if incident else None) == kind


def test_a_service_that_finds_a_fault_in_itself_is_one_and_one_that_had_it_before_is_none() -> None:
    incidents = IncidentDetector(CONFIG)
    incidents.on_health(health("old"), 1.0)
    incidents.on_health(health("old"), 2.0)
    assert incidents.due(50.0) is None
    incidents.on_health(health("new"), 3.0)
    assert incidents.due(50.0) == Incident("fault", "guard: new", -57_000_000_000)
    incidents.on_health(health("new", "newer"), 4.0)
    assert incidents.due(150.0) is not None
    incidents.on_health(health("newer"), 5.0)
    assert incidents.due(250.0) is None, "a fault that ends is none"


def test_of_two_processes_of_a_service_one_that_is_unwell_all_along_is_none() -> None:
    incidents = IncidentDetector(CONFIG)

    def hear(now: float, *faults: str) -> None:
        incidents.on_health(health(*faults), now)
        incidents.on_health(msgspec.structs.replace(health(), instance="another"), now)

    for now in (0.0, 5.0, 10.0):
        hear(now, "unplugged")
    incidents.on_health(msgspec.structs.replace(health("unplugged"), instance="restarted"), 15.0)
    assert incidents.due(100.0) is None
    for now in (100.0, 105.0):
        hear(now)
    hear(110.0, "unplugged")
    assert incidents.due(200.0) is not None, "it was well in between"


@pytest.mark.parametrize(
    ("service", "armed", "is_one"), [("guard", True, True), ("guard", False, False), ("watch", True, False)]
)
def test_a_service_that_goes_is_one_while_the_robot_is_armed(service: str, armed: bool, is_one: bool) -> None:
    incidents = IncidentDetector(CONFIG)
    incidents.on_base(base(armed=armed), 1.0)
    incidents.on_gone(service, 2.0)
    assert (incidents.due(50.0) is not None) == is_one


def test_an_emergency_stop_amid_smaller_events_names_the_file_and_has_its_own_time_after() -> None:
    """A busy robot tells of a fault shortly before, and whoever looks for the stop looks for its name."""
    incidents = IncidentDetector(CONFIG)
    incidents.on_estop(estop(engaged=False), 90.0)
    incidents.on_health(health(), 90.0)
    incidents.on_health(health("late"), 100.0)
    incidents.on_estop(estop(engaged=True), 103.0)
    at, incident = first_due(incidents, 103.0, 200.0)
    assert at == pytest.approx(108.0, abs=0.2)
    assert incident == Incident("estop", "emergency stop by ann@desk: smoke; guard: late", 40_000_000_000)
    assert incidents.due(1000.0) is None


KEYS = st.sampled_from(["k", "giraff/otto/odom", "giraff/otto/range/rear", "giraff/otto/range/x"])


@given(st.lists(st.tuples(st.integers(0, 10_000_000_000), KEYS, st.integers(0, 3000)), max_size=60))
def test_memory_is_bounded_in_time_and_bytes(steps: list[tuple[int, str, int]]) -> None:
    memory = Memory(RecorderConfig(before=20.0, after=1.0, memory=10_000))
    at_ns = 0
    for step, key, size in steps:
        at_ns += step
        memory.add([RawSample(at_ns, key, bytes(size), "")])
        kept = memory.since(-1)
        assert sum(len(sample.payload) for sample in kept) <= 10_000
        assert not kept or at_ns - kept[0].at_ns <= 21_000_000_000
        if len({key for _, key, _ in steps}) == 1:
            assert not kept or kept[-1].at_ns == at_ns


ROBOT: dict[str, tuple[float, int]] = {
    "tick": (50.0, 81),
    "tilt": (50.0, 135),
    "cmd_vel/joystick": (50.0, 299),
    "lease": (10.0, 376),
    "range/front_left": (1000 / 180, 157),
    "range/front_right": (1000 / 180, 157),
    "range/rear": (1000 / 180, 157),
    "cmd_vel": (50.0, 494),
    "wheels": (100.0, 222),
    "odom": (100.0, 277),
    "base": (10.0, 419),
    "battery": (2.0, 67),
    "guard": (10.0, 972),
    "estop": (2.0, 100),
}
"""Hz and largest bytes of each key of a robot that drives with a joystick."""


@cache
def a_minute() -> list[RawSample]:
    """Return what that robot says in 60 s, in order."""
    return sorted(
        RawSample(round(number / rate * 1e9), f"giraff/otto/{key}", bytes(size), "")
        for key, (rate, size) in ROBOT.items()
        for number in range(round(60 * rate))
    )


@pytest.mark.parametrize(
    ("keys", "size", "count", "suffers"),
    [
        (["maker/film", "range/rear", "odom"], 15_900_000, 6, ""),
        (["odom"], 60_000, 600, ""),
        (["tick", "guard", "estop", "cmd_vel/joystick"], 60_000, 600, ""),
        (["map"], 60_000, 600, ""),
        (["odom"], 277, 50_000, "odom"),  # 10 000 a second
        (["cmd_vel/joystick"], 299, 50_000, "cmd_vel/"),
        ([f"range/{number}" for number in range(5000)], 157, 50_000, "range/"),
        ([f"serial/{number}" for number in range(5000)], 2000, 25_000, ""),
        (["maker/film"], 200, 50_000, ""),
    ],
)
def test_a_flood_pushes_out_its_own_topic_alone(keys: list[str], size: int, count: int, suffers: str) -> None:
    memory = Memory(CONFIG)
    own = a_minute()
    assert len(own) == pytest.approx(27_000, rel=0.01)
    memory.add(own)
    memory.add([RawSample(own[-1].at_ns, "giraff/otto/maker/arm", b"1", "")])
    flood = [
        RawSample(own[-1].at_ns + n * 100_000, f"giraff/otto/{keys[n % len(keys)]}", bytes(size), "")
        for n in range(count)
    ]
    for begin in range(0, count, 2000):
        memory.add(flood[begin : begin + 2000])
    kept = memory.since(-1)
    assert sum(len(sample.payload) for sample in kept) <= CONFIG.memory
    assert kept == sorted(kept, key=lambda sample: sample.at_ns)
    there = {id(sample) for sample in kept}
    lost = {sample.key for sample in own if id(sample) not in there}
    assert lost == {sample.key for sample in own if suffers and sample.key.startswith(f"giraff/otto/{suffers}")}


def files(*kinds: str, days: float = 0.0) -> list[IncidentFile]:
    """Files of 10 bytes, `days` apart, oldest first."""
    return [IncidentFile(f"{number:02}-{kind}.mcap", 10, number * days * 86_400) for number, kind in enumerate(kinds)]


@pytest.mark.parametrize(
    ("given", "limits", "gone"),
    [
        ([], {}, []),
        (files("a", "a", "a", "a"), {"files": 3}, ["01-a.mcap"]),
        (files("b", *"a" * 20), {"files": 20}, ["02-a.mcap"]),
        (files("a", "b", *"a" * 4), {"files": 3}, ["02-a.mcap", "03-a.mcap", "04-a.mcap"]),
        (files("a", "b", "a", "a", days=5.0), {"files": 3}, ["00-a.mcap"]),
        (files("a", "b", "b", "c"), {"files": 2}, ["02-b.mcap", "00-a.mcap"]),
        (files("a", "b", "c"), {"disk": 9 * 12}, []),
        ([file._replace(size=60) for file in files("a", "b", "b")], {"disk": 100}, ["00-a.mcap", "01-b.mcap"]),
        ([file._replace(size=500) for file in files("a")], {"disk": 100}, []),
    ],
)
def test_the_oldest_files_go_but_one_of_each_kind_and_the_newest(
    given: list[IncidentFile], limits: dict[str, int], gone: list[str]
) -> None:
    assert surplus(given, RecorderConfig(**limits)) == gone


@pytest.mark.parametrize("field", RecorderConfig.__struct_fields__)
def test_a_limit_of_nothing_is_refused(field: str) -> None:
    with pytest.raises(ValueError, match=field):
        RecorderConfig(**{field: 0})
