"""How a run went, in numbers."""

import math
from typing import Final

import msgspec

from giraff_cli.run.telemetry import AgeSummary, OdometryError, RunTelemetry
from giraff_core.kinematics.pose import ELLIPSE_95, mahalanobis
from giraff_core.latest import Latest
from giraff_schemas.messages import Odometry
from giraff_schemas.topics import BASE, CAMERA_STATE, ODOM, topic_of
from giraff_sim.bodies.registry import DrawnBody
from giraff_sim.truth import Level, TrueCamera
from giraff_sim.truth import Truth as Drawn
from giraff_telemetry.localization_summary import LocalizationSummary, localization_rows
from giraff_telemetry.visual_odometry import VisualSummary, visual_rows
from giraff_tools.terminal.text import counted, json_page

_LABEL: Final = 15  # characters
_INDENT: Final = " " * (_LABEL + 2)
_RATES_A_LINE: Final = 3


class BalanceSummary(msgspec.Struct, frozen=True, kw_only=True):
    """How a robot that balances has truly stood."""

    lean_sd_deg: float
    drift_m: float
    """The farthest that it came from where it had settled, before it drove or was pushed."""
    falls: int
    """Until it was made to sit down at the end."""
    sat_down: bool
    drawn: DrawnBody | None
    """How its body differs from its file."""


class Summary(msgspec.Struct, frozen=True, kw_only=True):
    """As it is written by `--summary`. None where nothing was heard to tell by."""

    robot: str
    boards: str
    seed: int
    duration_s: float
    """From when all services were there, the coming to rest at the end included."""
    distance_m: float
    """That the robot truly moved."""
    odom_error_m: float | None
    """Between odometry and truth at the end, at rest; both began at one pose, or where odometry's was set."""
    odom_error_deg: float | None
    odom_sigma_m: float | None
    """What odometry itself takes that error for: its standard deviation, by its own covariance."""
    odom_sigma_deg: float | None
    odom_mahalanobis: float | None
    """How many of its standard deviations its place is off, by their shape."""
    within_ellipse: bool | None
    """Whether the truth lies within the ellipse that should hold it with 95 %: an error as odometry expects them."""
    truth: Level
    """How far the robot could differ from its file."""
    drawn: Drawn | None
    """How it did, from what it was built as: a calibration in the file is no part of this. Of a robot that
    balances `balance` tells."""
    closest_m: float
    """To anything in the room, ever."""
    contacts: int
    balance: BalanceSummary | None
    """None: it stands by itself."""
    frames_lost: int
    """Samples that are missing from the sequence of their maker."""
    lost_by_key: dict[str, int]
    """The same, of keys that lost any."""
    line_errors: int | None
    """Frames that arrived torn or wrong over the base board's serial line."""
    rates_hz: dict[str, float]
    """By key. What boards pace is measured in their time, the rest in the host's."""
    age_ms: AgeSummary | None
    """Of the operator's measurement, when the guard's command that goes back to it reached base's host."""
    localization: LocalizationSummary | None
    """Where it was taken to be on the map, and how far off that was; None: nothing was heard of that."""
    visual: VisualSummary | None
    """How the camera saw the motion, beside wheels and truth. None: nothing was heard of giraff_vision."""
    skew_percent: float
    """By which simulated time went slower than the wall's."""
    failures: list[str]
    """What went wrong; empty: nothing."""


def summarize(
    telemetry: RunTelemetry,
    *,
    robot: str,
    boards: str,
    seed: int,
    truth: Level,
    drawn: Drawn | None,
    began_ns: int,
    failures: list[str],
) -> Summary:
    """The numbers of the run that began at `began_ns` (robot's clock) and ends with the newest look at the world."""
    world, apart = telemetry.truth, telemetry.apart
    base = telemetry.latest(BASE, world.robot_ns)
    odometry = telemetry.latest(ODOM, world.robot_ns)
    sigma = None if apart is None else _sigma(odometry)
    off = None if apart is None else _mahalanobis(apart, odometry)
    return Summary(
        robot=robot,
        boards=boards,
        seed=seed,
        duration_s=round((world.robot_ns - began_ns) * 1e-9, 3),
        distance_m=round(world.path, 4),
        odom_error_m=None if apart is None else round(apart.distance, 4),
        odom_error_deg=None if apart is None else round(math.degrees(apart.angle), 3),
        odom_sigma_m=None if sigma is None else round(sigma.distance, 4),
        odom_sigma_deg=None if sigma is None else round(math.degrees(sigma.angle), 3),
        odom_mahalanobis=None if off is None else round(off, 2),
        within_ellipse=None if off is None else off <= ELLIPSE_95,
        truth=truth,
        drawn=drawn if telemetry.balance is None else None,
        closest_m=round(world.closest, 4),
        contacts=world.contacts,
        balance=_balance(telemetry),
        frames_lost=sum(telemetry.lost.values()),
        lost_by_key=telemetry.lost,
        line_errors=None if base is None else base.sample.board.line_errors,
        rates_hz={key: round(rate, 3) for key, rate in telemetry.rates_hz.items()},
        age_ms=telemetry.age_ms,
        localization=telemetry.localization,
        visual=telemetry.visual,
        skew_percent=round(telemetry.skew * 100, 3),
        failures=failures,
    )


def to_json(summary: Summary) -> str:
    return json_page(summary) + "\n"


def to_text(summary: Summary) -> str:
    """For people."""
    age, error = summary.age_ms, summary.odom_error_m
    per_cent = f" ({error / summary.distance_m:.2%} of the way)" if error is not None and summary.distance_m else ""
    rows = [
        ("robot", f"{summary.robot}, {summary.boards} boards, seed {summary.seed}"),
        ("duration", f"{summary.duration_s:.1f} s, simulated time {_behind(summary.skew_percent)}"),
        ("distance", f"{summary.distance_m:.2f} m"),
        ("odometry off by", "unknown" if error is None else f"{error:.3f} m, {summary.odom_error_deg:.2f}°{per_cent}"),
        ("its own sigma", _claim(summary)),
        *(visual_rows(summary.visual) if summary.visual is not None else ()),
        *(localization_rows(summary.localization) if summary.localization is not None else ()),
        ("true robot", _difference(summary)),
        ("closest", f"{summary.closest_m:.3f} m, {counted(summary.contacts, 'contact')}"),
        *([("balance", _stood(summary.balance))] if summary.balance is not None else []),
        ("samples lost", _losses(summary)),
        ("line errors", "unknown" if summary.line_errors is None else f"{summary.line_errors}"),
        ("command age", "unknown" if age is None else f"{age.p50} ms median, {age.p99} ms p99, {age.max} ms at most"),
        ("rates in Hz", _rates(summary.rates_hz)),
        *(("went wrong", failure) for failure in summary.failures),
    ]
    indented = ((label, value.replace("\n", f"\n{_INDENT}")) for label, value in rows)
    return "\n".join(f"{label:>{_LABEL}}  {value}" for label, value in indented)


def _balance(telemetry: RunTelemetry) -> BalanceSummary | None:
    if (balance := telemetry.balance) is None:
        return None
    return BalanceSummary(
        lean_sd_deg=round(math.degrees(balance.lean_sd), 3),
        drift_m=round(telemetry.drift, 4),
        falls=balance.falls,
        sat_down=telemetry.has_sat_down,
        drawn=telemetry.truth.drawn,
    )


def _stood(balance: BalanceSummary) -> str:
    ended = ", sat down" if balance.sat_down else ""
    return (
        f"lean {balance.lean_sd_deg:.2f}° sd, drifted {balance.drift_m:.2f} m, {counted(balance.falls, 'fall')}{ended}"
    )


def _sigma(odometry: Latest[Odometry] | None) -> OdometryError | None:
    """Standard deviations by the covariance of a sample: of the distance and of the heading."""
    if odometry is None:
        return None
    xx, _, _, yy, _, tt = odometry.sample.covariance
    return OdometryError(math.sqrt(xx + yy), math.sqrt(tt))


def _mahalanobis(apart: OdometryError, odometry: Latest[Odometry] | None) -> float | None:
    if odometry is None:
        return None
    xx, xy, _, yy, _, _ = odometry.sample.covariance
    return mahalanobis(apart.x, apart.y, xx, xy, yy)


def _claim(summary: Summary) -> str:
    if summary.odom_sigma_m is None or summary.odom_sigma_deg is None:
        return "unknown"
    where = "within" if summary.within_ellipse else "OUTSIDE"
    off = f"truth {where} its 95 % ellipse, {summary.odom_mahalanobis:.2f} sigma off"
    return f"{summary.odom_sigma_m:.3f} m, {summary.odom_sigma_deg:.2f}°,\n{off}"


def _difference(summary: Summary) -> str:
    """The drawn robot beside its file."""
    level, drawn, balance = summary.truth, summary.drawn, summary.balance
    if balance is not None and balance.drawn is not None and level != "exact":
        return f"{level}: {balance.drawn.told}"
    if drawn is None and balance is None:
        return f"{level}, unknown"
    if level == "exact":
        return "exact: as its file says"
    assert drawn is not None, "it has one body or the other"  # noqa: S101
    left, right = drawn.left, drawn.right
    geometry = f"wheels {left.scale - 1.0:+.2%} {right.scale - 1.0:+.2%}, track {drawn.track_scale - 1.0:+.2%}"
    motors = f"motors {left.strength:.0%} {right.strength:.0%}, {drawn.turn_slip:.1%} of turning slips"
    has_camera = any(topic_of(key) is CAMERA_STATE for key in summary.rates_hz)
    return f"{level}: {geometry},\n{motors}{_sees(drawn.camera) if has_camera else ''}"


def _sees(camera: TrueCamera) -> str:
    height, focal = camera.height_scale - 1.0, camera.focal_scale - 1.0
    return f",\ncamera {height:+.2%} high, {math.degrees(camera.pitch):+.2f}° down, focal length {focal:+.2%}"


def _rates(rates_hz: dict[str, float]) -> str:
    shown = [f"{key} {rate:.1f}" for key, rate in rates_hz.items()]
    lines = [", ".join(shown[start : start + _RATES_A_LINE]) for start in range(0, len(shown), _RATES_A_LINE)]
    return ",\n".join(lines) or "none heard"


def _losses(summary: Summary) -> str:
    by_key = ", ".join(f"{key} {lost}" for key, lost in summary.lost_by_key.items())
    return f"{summary.frames_lost} ({by_key})" if by_key else "0"


def _behind(percent: float) -> str:
    return f"{abs(percent):.2f} % {'slower' if percent >= 0.0 else 'faster'} than the wall's"
