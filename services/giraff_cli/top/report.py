"""A robot's services, hosts and topics at one moment: what they take and how they flow. No clock, no network."""

from collections import deque
from typing import Final

import msgspec
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from giraff_schemas.health import Health
from giraff_schemas.text import printable
from giraff_schemas.topics import topic_of
from giraff_tools.network.robot_graph import RobotGraph
from giraff_tools.network.statistics import PublisherStatistics, TopicStatistics
from giraff_tools.terminal.page import shown, table_of
from giraff_tools.terminal.text import json_line

_WINDOW: Final = 3.0  # s that the figures of now look back
_PERIODS: Final = 3.0  # of a topic, without a sample: it is silent
_LEAST: Final = 1.0  # s
_SLOW: Final = 0.8  # of the nominal rate


class ProcessRow(msgspec.Struct, frozen=True, kw_only=True):
    """A process."""

    service: str
    instance: str
    host: str
    """Empty: it does not answer."""
    pid: int
    cpu: float | None
    """Of one core, over the last moments; None: not told yet."""
    rss_bytes: int
    ok: bool
    told: tuple[str, ...]
    """Its faults and notices."""


class TopicRow(msgspec.Struct, frozen=True, kw_only=True):
    """One maker's samples of a key."""

    key: str
    by: str
    hz: float | None
    """None: silent, or too few to tell."""
    nominal_hz: float
    lost: int
    reordered: int
    duplicated: int
    age_median: float | None
    """s from the maker's stamp to here, by both hosts' wall clocks."""
    silence: float
    """s since the newest."""
    silent: bool
    """That is longer than its rate explains."""


class TopReport(msgspec.Struct, frozen=True, kw_only=True):
    """All of it. Its field names are kept."""

    robot: str
    elapsed: float
    services: list[ProcessRow]
    hosts: dict[str, tuple[float, int]]
    """By host, what the services there take together: of one core, bytes."""
    topics: list[TopicRow]


class Loads:
    """What the processes take now, from what they say at one time and another."""

    def __init__(self) -> None:
        self._told: dict[str, deque[Health]] = {}

    def update(self, robot_graph: RobotGraph) -> None:
        """The newest answers."""
        self._told = {instance: told for instance, told in self._told.items() if instance in robot_graph.alive}
        for instance, health in robot_graph.healths.items():
            told = self._told.setdefault(instance, deque())
            if not told or health.uptime > told[-1].uptime:
                told.append(health)
            while len(told) > 2 and told[1].uptime <= health.uptime - _WINDOW:
                told.popleft()

    def cpu(self, instance: str) -> float | None:
        """Of one core."""
        told = self._told.get(instance)
        if told is None or told[-1].uptime <= told[0].uptime:
            return None
        return (told[-1].cpu_time - told[0].cpu_time) / (told[-1].uptime - told[0].uptime)


class TopView(msgspec.Struct, frozen=True):
    """What is to be seen."""

    report: TopReport
    as_json: bool

    @property
    def elapsed(self) -> float:
        return self.report.elapsed

    def line(self) -> str:
        """For a script, or for a log."""
        report = self.report
        if self.as_json:
            return json_line(report)
        work = "  ".join(f"{work.service} {_percent(work.cpu)}" for work in report.services)
        lost = sum(stream.lost for stream in report.topics)
        slow = [f"{stream.key} {shown(stream.hz)} Hz" for stream in report.topics if _is_slow(stream)]
        return f"{report.elapsed:6.1f} s | {work or 'nobody there'} | lost {lost} | slow: {', '.join(slow) or 'none'}"

    def render(self) -> RenderableType:
        """For people."""
        report = self.report
        hosts = ", ".join(f"{host} {_percent(cpu)} {_megabytes(rss)}" for host, (cpu, rss) in report.hosts.items())
        title = Text(printable(f"{report.robot}  {report.elapsed:.0f} s  {hosts}"), style="bold")
        return Group(title, Text(), _services(report), Text(), _topics(report))


def report_of(robot_graph: RobotGraph, loads: Loads, elapsed: float, now: float) -> TopReport:
    """`now`: monotonic, s."""
    services = [
        ProcessRow(
            service=maker.service,
            instance=maker.instance,
            host="" if health is None else health.host,
            pid=0 if health is None else health.pid,
            cpu=loads.cpu(maker.instance),
            rss_bytes=0 if health is None else health.rss_bytes,
            ok=health is not None and health.ok,
            told=("does not answer",) if health is None else tuple(map(str, (*health.faults, *health.notices))),
        )
        for maker in robot_graph.services
        for health in [robot_graph.healths.get(maker.instance)]
    ]
    hosts: dict[str, tuple[float, int]] = {}
    for work in services:
        cpu, rss = hosts.get(work.host, (0.0, 0))
        if work.host:
            hosts[work.host] = cpu + (work.cpu or 0.0), rss + work.rss_bytes
    streams = [
        _stream(statistics, robot_graph.maker(instance).name, count, now)
        for statistics in (robot_graph.topics[key] for key in robot_graph.keys if key in robot_graph.topics)
        for instance, count in statistics.counts.items()
    ]
    return TopReport(
        robot=robot_graph.robot,
        elapsed=round(elapsed, 3),
        services=services,
        hosts=dict(sorted(hosts.items())),
        topics=streams,
    )


def _stream(statistics: TopicStatistics, by: str, count: PublisherStatistics, now: float) -> TopicRow:
    row = topic_of(statistics.key)
    nominal = 0.0 if row is None else row.rate_hz
    silence = now - count.newest.at
    silent = silence > max(_LEAST, _PERIODS / nominal if nominal else 0.0)
    median = count.ages.quantile(0.5)
    return TopicRow(
        key=statistics.key,
        by=by,
        hz=None if silent else count.rate_over(_WINDOW),
        nominal_hz=nominal,
        lost=count.lost,
        reordered=count.reordered,
        duplicated=count.duplicated,
        age_median=None if median is None else round(median * 1e-3, 4),
        silence=round(silence, 3),
        silent=silent,
    )


def _services(report: TopReport) -> Table:
    return table_of(
        ("service", "host", ">pid", ">CPU", ">memory", "state"),
        (
            (
                work.service,
                work.host or "?",
                str(work.pid or "?"),
                _percent(work.cpu),
                _megabytes(work.rss_bytes),
                Text(printable("; ".join(work.told) or "well"), style="" if work.ok else "bold red"),
            )
            for work in report.services
        ),
    )


def _topics(report: TopReport) -> Table:
    return table_of(
        ("key", "by", ">Hz", ">of", ">lost", ">reordered", ">double", ">age ms"),
        (
            (
                stream.key,
                stream.by,
                Text(shown(stream.hz), style="yellow" if _is_slow(stream) else ""),
                shown(stream.nominal_hz) if stream.nominal_hz else "on change",
                Text(str(stream.lost), style="yellow" if stream.lost else ""),
                str(stream.reordered),
                str(stream.duplicated),
                shown(None if stream.age_median is None else stream.age_median * 1e3),
            )
            for stream in report.topics
        ),
    )


def _is_slow(stream: TopicRow) -> bool:
    if stream.hz is None:
        return stream.silent and stream.nominal_hz > 0.0
    return stream.hz < _SLOW * stream.nominal_hz


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{share * 100.0:.1f} %"


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.0f} MB" if size else "-"
