"""How well the robot knew where it was on the map, in numbers, over a whole drive."""

import math
from textwrap import wrap
from typing import Final

import msgspec

from giraff_schemas.localization import LocalizationState, MapPose
from giraff_schemas.text import printable
from giraff_telemetry.localization import WayByState, place_text, shares_text, sigma_of
from giraff_telemetry.localization_error import LocalizationErrors, Spread

WIDTH: Final = 62
"""Characters of a line of a value."""


class MapErrorSummary(msgspec.Struct, frozen=True, kw_only=True):
    """By the world's truth. Of what was said while it was `localized`, where not else said; None: it never was."""

    median_m: float | None
    p95_m: float | None
    worst_m: float | None
    median_deg: float | None
    p95_deg: float | None
    worst_deg: float | None
    end_m: float
    """Of the last pose that the truth reaches up to, whatever its state."""
    end_deg: float


class LocalizationSummary(msgspec.Struct, frozen=True, kw_only=True):
    """The pose is the last there was."""

    map: str
    """Name of the floor plan; empty: there was none."""
    state: LocalizationState
    x: float
    """m; `base_link` in `map`."""
    y: float
    yaw_deg: float
    sigma_m: float
    """Standard deviation of the place, by its own covariance."""
    sigma_deg: float
    explained: float
    """Share of the newest readings that this place explains, 0..1."""
    reason: str
    shares: dict[LocalizationState, float] | None
    """Of the way in each state, 0..1; None: it has not moved."""
    error: MapErrorSummary | None
    """None: the truth on the map is not known."""


def summarize_localization(pose: MapPose, way: WayByState, errors: LocalizationErrors) -> LocalizationSummary:
    """Of a drive that has ended with this pose."""
    metres, radians = sigma_of(pose)
    shares = way.shares
    return LocalizationSummary(
        map=pose.map,
        state=pose.state,
        x=round(pose.x, 4),
        y=round(pose.y, 4),
        yaw_deg=round(math.degrees(pose.yaw), 3),
        sigma_m=round(metres, 4),
        sigma_deg=round(math.degrees(radians), 3),
        explained=round(pose.explained, 4),
        reason=str(pose.reason),
        shares=None if shares is None else {state: round(share, 4) for state, share in shares.items()},
        error=_error(errors),
    )


def localization_rows(summary: LocalizationSummary) -> list[tuple[str, str]]:
    """For people: labels of at most 15 characters, and values, whose lines fit beside them."""
    place = place_text(summary.x, summary.y, math.radians(summary.yaw_deg))
    where = f"at {place}, ± {summary.sigma_m:.3f} m, {summary.sigma_deg:.1f}°"
    told = f"{summary.state.replace('_', ' ')}{'' if summary.state == 'no_map' else f' {where}'}"
    rows = [
        ("localization", "\n".join([told, *wrap(printable(summary.reason), WIDTH)])),
        ("knew its place", shares_text(summary.shares)),
    ]
    error = summary.error
    if error is None:
        return rows
    if error.median_m is not None and error.median_deg is not None:
        off = f"{error.median_m:.3f} m, {error.median_deg:.1f}° median, {error.p95_m:.3f} m, {error.p95_deg:.1f}° p95"
        rows.append(("place off by", f"{off}, {error.worst_m:.3f} m at most"))
    return [*rows, ("off at the end", f"{error.end_m:.3f} m, {error.end_deg:.1f}°")]


def _error(errors: LocalizationErrors) -> MapErrorSummary | None:
    if errors.newest is None:
        return None
    metres, radians = errors.distances, errors.angles
    return MapErrorSummary(
        median_m=_rounded(metres, "median", 1.0, 4),
        p95_m=_rounded(metres, "p95", 1.0, 4),
        worst_m=_rounded(metres, "worst", 1.0, 4),
        median_deg=_rounded(radians, "median", math.degrees(1.0), 3),
        p95_deg=_rounded(radians, "p95", math.degrees(1.0), 3),
        worst_deg=_rounded(radians, "worst", math.degrees(1.0), 3),
        end_m=round(errors.newest.distance, 4),
        end_deg=round(math.degrees(errors.newest.angle), 3),
    )


def _rounded(spread: Spread | None, name: str, unit: float, digits: int) -> float | None:
    return None if spread is None else round(getattr(spread, name) * unit, digits)
