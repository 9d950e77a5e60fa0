"""`giraff topic hz` and `bw`: how often and how much, of what was sent and of what came."""

from collections.abc import Iterator, Sequence
from typing import Any, Final

import msgspec

from giraff_schemas.text import printable
from giraff_schemas.topics import Topic, topic_of
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.robot_graph import GraphMonitor, NodeId, RobotGraph
from giraff_tools.network.statistics import PublisherStatistics, TopicStatistics
from giraff_tools.network.topic_keys import UnknownKeyError, below_robot, find_heard_topic
from giraff_tools.terminal.page import print_json, print_table, shown
from giraff_tools.terminal.signals import StopSignal

_WELL: Final = 0
_ILL: Final = 1


class Rate(msgspec.Struct, frozen=True, kw_only=True):
    """How one maker's samples of a key travel, from the first to the newest that was heard."""

    key: str
    maker: NodeId
    hz: float | None
    """By the maker's own numbers and stamps, whatever became of the samples; None: too few to tell.

    A key of a maker who numbers nothing is counted as it comes: what was lost of it nobody knows."""
    nominal_hz: float
    """0: on change only."""
    sent: int
    heard: int
    lost: int = 0
    reordered: int = 0
    """Of those heard: after a later one."""
    duplicated: int = 0
    """Heard once more."""
    age_median: float | None = None
    """s from the maker's stamp to here, by the wall clocks of both hosts, which may disagree."""
    age_p99: float | None = None
    age_largest: float | None = None
    clock_leap: float = 0.0
    """s. How far the maker's wall clock leapt meanwhile; 0: it did not. After a leap `hz` goes by arrivals."""


class Rates(msgspec.Struct, frozen=True, kw_only=True):
    """The answer of `hz`."""

    robot: str
    rates: list[Rate]
    unreadable: dict[str, int]
    """By key, what came and is no sample."""

    @property
    def well(self) -> bool:
        """Whether all that was sent came, once and in order."""
        return not self.unreadable and not any(rate.lost or rate.reordered or rate.duplicated for rate in self.rates)


class Bandwidth(msgspec.Struct, frozen=True, kw_only=True):
    """What the payloads of a key take."""

    key: str
    bytes_per_second: float | None
    """None: too few came to tell."""
    samples: int
    bytes: int
    smallest: int
    """Bytes of a payload."""
    largest: int


def hz(key: str | None, robot: str | None, connect: Sequence[str], seconds: float, *, as_json: bool) -> int:
    """Count for `seconds` and print it; the exit code."""

    def report(robot_graph: RobotGraph) -> int:
        rates = rates_of(robot_graph)
        if as_json:
            print_json(rates)
        else:
            _show_rates(rates)
        return _WELL if rates.well else _ILL

    return _measure(key, robot, connect, seconds, report)


def bw(key: str | None, robot: str | None, connect: Sequence[str], seconds: float, *, as_json: bool) -> int:
    """Weigh for `seconds` and print it; the exit code."""

    def report(robot_graph: RobotGraph) -> int:
        widths = bandwidths_of(robot_graph)
        if as_json:
            print_json(widths)
        else:
            _show_bandwidths(widths)
        return _WELL

    return _measure(key, robot, connect, seconds, report)


def rates_of(robot_graph: RobotGraph) -> Rates:
    """Of each key and maker that was heard."""
    return Rates(
        robot=robot_graph.robot,
        rates=[
            rate
            for key in robot_graph.keys
            if (statistics := robot_graph.topics.get(key)) is not None
            for rate in _rates(robot_graph, key, statistics)
        ],
        unreadable={
            key: statistics.unreadable
            for key, statistics in robot_graph.topics.items()
            if statistics.unreadable and topic_of(key) is not None
        },
    )


def bandwidths_of(robot_graph: RobotGraph) -> list[Bandwidth]:
    """Of each key that was heard."""
    return [
        Bandwidth(
            key=key,
            bytes_per_second=statistics.bytes_per_second,
            samples=statistics.samples,
            bytes=statistics.bytes,
            smallest=statistics.smallest,
            largest=statistics.largest,
        )
        for key in robot_graph.keys
        if (statistics := robot_graph.topics.get(key)) is not None
    ]


def _measure(key: str | None, robot: str | None, connect: Sequence[str], seconds: float, tell: Any) -> int:
    try:
        key, robot = below_robot(key or "", robot)
        topic = find_heard_topic(key) if key else None
    except UnknownKeyError as error:
        return print_error(str(error))

    def act(connection: RobotConnection) -> int:
        robot_graph = GraphMonitor.counting(connection, topic).run(seconds, stopping)
        if robot_graph.topics:
            return int(tell(robot_graph))
        return print_error(_silence(robot_graph, topic, seconds))

    with StopSignal() as stopping:
        return run_with_robot(robot, connect, act)


def _silence(robot_graph: RobotGraph, topic: Topic[Any] | None, seconds: float) -> str:
    if topic is None:
        return f"{robot_graph.robot} says nothing in {seconds:g} s"
    return robot_graph.instead(topic) or f"nothing came on {topic.key} in {seconds:g} s"


def _rates(robot_graph: RobotGraph, key: str, statistics: TopicStatistics) -> Iterator[Rate]:
    for instance, count in statistics.counts.items():
        yield _rate(key, robot_graph.maker(instance), count)
    if topic_of(key) is None and not statistics.counts:
        yield Rate(
            key=key,
            maker=NodeId("", ""),
            hz=statistics.arrival_rate,
            nominal_hz=0.0,
            sent=statistics.samples,
            heard=statistics.samples,
        )


def _rate(key: str, maker: NodeId, count: PublisherStatistics) -> Rate:
    row = topic_of(key)
    median, high, largest = (_seconds(count.ages.quantile(share)) for share in (0.5, 0.99, 1.0))
    return Rate(
        key=key,
        maker=maker,
        hz=count.rate,
        nominal_hz=0.0 if row is None else row.rate_hz,
        sent=count.sent,
        heard=count.heard,
        lost=count.lost,
        reordered=count.reordered,
        duplicated=count.duplicated,
        age_median=median,
        age_p99=high,
        age_largest=largest,
        clock_leap=round(count.leap, 3),
    )


def _show_rates(rates: Rates) -> None:
    headings = (">Hz", ">of", ">sent", ">heard", ">lost", ">reordered", ">double", ">age ms", ">p99", ">largest")
    print_table(
        ("key", "by", *headings),
        (
            (
                rate.key,
                rate.maker.name,
                shown(rate.hz, ".2f"),
                shown(rate.nominal_hz) if rate.nominal_hz else "on change",
                *(str(number) for number in (rate.sent, rate.heard, rate.lost, rate.reordered, rate.duplicated)),
                *(shown(_milliseconds(age)) for age in (rate.age_median, rate.age_p99, rate.age_largest)),
            )
            for rate in rates.rates
        ),
    )
    for maker, leap in {rate.maker: rate.clock_leap for rate in rates.rates if rate.clock_leap}.items():
        print_error(printable(f"the clock of {maker.name} leapt by {leap:+.1f} s meanwhile: its ages are wrong"))
    for key, number in rates.unreadable.items():
        print_error(printable(f"unreadable on {key}: {number}"))


def _show_bandwidths(widths: Sequence[Bandwidth]) -> None:
    total = sum(width.bytes_per_second or 0.0 for width in widths)
    rows = [
        (
            width.key,
            shown(width.bytes_per_second, ".0f"),
            str(width.samples),
            str(width.bytes),
            str(width.smallest),
            str(width.largest),
        )
        for width in widths
    ]
    headings = ("key", ">bytes/s", ">samples", ">bytes", ">smallest", ">largest")
    print_table(headings, [*rows, ("all", shown(total, ".0f"), "", "", "", "")] if len(rows) > 1 else rows)


def _seconds(milliseconds: float | None) -> float | None:
    return None if milliseconds is None else round(milliseconds * 1e-3, 4)


def _milliseconds(seconds: float | None) -> float | None:
    return None if seconds is None else seconds * 1e3
