"""What a localization says of drives, against the truth."""

import math
import statistics
from collections.abc import Callable, Iterable, Sequence
from typing import Final, NamedTuple

from giraff_localization.policy import LocalizationPolicy
from giraff_schemas.localization import LocalizationSetPose, LocalizationState, MapPose
from giraff_schemas.messages import Odometry
from giraff_sim.world.room import Pose
from tests.loop.localization.drives import Drive
from tests.loop.reaction import quantile

RIGHT: Final = 0.5  # m from the truth, at most
WRONG: Final = 1.0  # m from it, at least
QUIET_WITHIN: Final = 5.0  # m after it was kidnapped, in which it may not know yet
NOT_THE_MAP: Final = "may not be the map"
NEVER: Final = math.inf
_EACH: Final = 0.1  # m of way
_EACH_TURN: Final = math.radians(10.0)


class Row(NamedTuple):
    """What it says each 0.1 m or 10 degrees."""

    path: float
    """m"""
    error: float
    """m from the truth."""
    yaw_error: float
    """rad, without a sign."""
    state: LocalizationState
    is_near: bool
    """Whether the best place, or another candidate, is right."""
    doubts_the_map: bool
    ms: float
    """Of computing since the last row; 0 without a clock."""
    particles: int

    @property
    def is_right(self) -> bool:
        return self.error < RIGHT

    @property
    def is_wrong(self) -> bool:
        """It says that it knows, and does not."""
        return self.state == "localized" and self.error > WRONG


def rows(
    drive: Drive, policy: LocalizationPolicy, *, tracks: bool = False, clock: Callable[[], float] | None = None
) -> list[Row]:
    """Feed a drive to a policy. `tracks`: it is told where it starts; `clock`: s, for how long an update takes."""
    found: list[Row] = []
    last, ms = drive.moments[0], 0.0
    is_told = not tracks
    for moment in drive.moments:
        if isinstance(moment.message, Odometry):
            policy.on_odometry(moment.message)
            if not is_told:
                is_told = True
                assert policy.on_set_pose(told(moment.truth)).done
        else:
            policy.on_sample(moment.message)
        began = clock() if clock else 0.0
        while policy.work():
            pass
        ms += (clock() - began) * 1000.0 if clock else 0.0
        moves = (
            moment.path - last.path >= _EACH
            or abs(math.remainder(moment.truth.yaw - last.truth.yaw, math.tau)) >= _EACH_TURN
        )
        if moves and isinstance(moment.message, Odometry):
            found.append(_row(policy.pose(), moment.truth, moment.path, ms))
            last, ms = moment, 0.0
    return found


def told(pose: Pose) -> LocalizationSetPose:
    """What somebody says who knows where it is, to a hand's breadth."""
    return LocalizationSetPose(by="test", id=1, x=pose.x, y=pose.y, yaw=pose.yaw, position_sd=0.1, yaw_sd=0.1)


def _row(pose: MapPose, truth: Pose, path: float, ms: float) -> Row:
    error = math.hypot(pose.x - truth.x, pose.y - truth.y)
    near = [math.hypot(place.x - truth.x, place.y - truth.y) for place in pose.candidates]
    return Row(
        path=path,
        error=error,
        yaw_error=abs(math.remainder(pose.yaw - truth.yaw, math.tau)),
        state=pose.state,
        is_near=min(error, *near, math.inf) < RIGHT,
        doubts_the_map=NOT_THE_MAP in str(pose.reason),
        ms=ms,
        particles=pose.particles,
    )


class Run(NamedTuple):
    """What became of one drive."""

    seed: int
    rows: list[Row]
    kidnapped_at: float | None

    @property
    def first(self) -> float:
        """m until it is localized, and right."""
        return next((row.path for row in self.rows if row.state == "localized" and row.is_right), NEVER)

    @property
    def quiet(self) -> float:
        """m after it was kidnapped until it no longer says that it is where it is not."""
        return next((row.path - self._kidnapped for row in self._after if not self._misleads(row)), NEVER)

    @property
    def again(self) -> float:
        """m after it was kidnapped until it is localized again, and right."""
        found = (row.path - self._kidnapped for row in self._after if row.state == "localized" and row.is_right)
        return next(found, NEVER)

    @property
    def doubts(self) -> float:
        """m until it says that this may not be the map."""
        return next((row.path for row in self.rows if row.doubts_the_map), NEVER)

    @property
    def wrong(self) -> list[Row]:
        """Where it says that it knows, and does not: but just after it was kidnapped."""
        return [row for row in self.judged if row.is_wrong]

    @property
    def judged(self) -> list[Row]:
        """All but just after it was kidnapped, of which `quiet` tells."""
        kidnapped = math.inf if self.kidnapped_at is None else self.kidnapped_at
        return [row for row in self.rows if not kidnapped <= row.path < kidnapped + QUIET_WITHIN]

    @property
    def _kidnapped(self) -> float:
        assert self.kidnapped_at is not None
        return self.kidnapped_at

    @property
    def _after(self) -> list[Row]:
        return [row for row in self.rows if row.path >= self._kidnapped]

    @staticmethod
    def _misleads(row: Row) -> bool:
        return row.state == "localized" and not row.is_right


class Verdict(NamedTuple):
    """What becomes of the drives of one kind. NaN where there is nothing to tell it by."""

    runs: int
    median: float
    """m from the truth while it is localized; all the way where it was told where it starts."""
    p95: float
    largest: float
    yaw_p95: float
    """rad"""
    localized: float
    """Share of the way."""
    ambiguous: float
    lost: float
    first_median: float
    """m until it is localized, and right."""
    first_longest: float
    localized_after_first: float
    """Share of what is left of the way then."""
    wrong: float
    """Share of the way in which it is localized more than 1 m off; 5 m after a kidnapping are not counted."""
    wrong_runs: tuple[int, ...]
    """Their seeds."""
    near_while_ambiguous: float
    """Share of it with the right place among the candidates."""
    quiet_longest: float
    """m after it was kidnapped until it no longer says that it is localized."""
    again_median: float
    again_longest: float
    doubts_longest: float
    """m until it says that this may not be the map."""
    ms_median: float
    """Of an update."""
    ms_p99: float
    particles_median: float


def verdict(runs: Sequence[Run], *, tracks: bool = False) -> Verdict:
    """Of all drives of one kind."""
    every = [row for run in runs for row in run.rows]
    known = [row for row in every if row.state == "localized"]
    judged = every if tracks else [row for run in runs for row in run.judged if row.state == "localized"]
    ambiguous = [row for row in every if row.state == "ambiguous"]
    first = [run.first for run in runs]
    kidnapped = [run for run in runs if run.kidnapped_at is not None]
    later = [row.state == "localized" for run in runs for row in run.rows if row.path >= run.first]
    errors = [row.error for row in judged]
    return Verdict(
        runs=len(runs),
        median=_quantile(errors, 0.5),
        p95=_quantile(errors, 0.95),
        largest=max(errors, default=math.nan),
        yaw_p95=_quantile([row.yaw_error for row in judged], 0.95),
        localized=len(known) / len(every),
        ambiguous=len(ambiguous) / len(every),
        lost=sum(row.state == "lost" for row in every) / len(every),
        first_median=statistics.median(first),
        first_longest=max(first),
        localized_after_first=_share(later),
        wrong=sum(len(run.wrong) for run in runs) / len(every),
        wrong_runs=tuple(run.seed for run in runs if run.wrong),
        near_while_ambiguous=_share([row.is_near for row in ambiguous]),
        quiet_longest=max((run.quiet for run in kidnapped), default=math.nan),
        again_median=_quantile([run.again for run in kidnapped], 0.5),
        again_longest=max((run.again for run in kidnapped), default=math.nan),
        doubts_longest=max(run.doubts for run in runs),
        ms_median=_quantile([row.ms for row in every], 0.5),
        ms_p99=_quantile([row.ms for row in every], 0.99),
        particles_median=_quantile([row.particles for row in every], 0.5),
    )


def _share(held: Iterable[bool]) -> float:
    all_held = list(held)
    return sum(all_held) / len(all_held) if all_held else math.nan


def _quantile(values: Sequence[float], share: float) -> float:
    return quantile(list(values), share) if values else math.nan


def line(kind: str, found: Verdict) -> str:
    """All of it that a person looks at first, in one line."""
    text = (
        f"{kind:12s} {found.runs:3d} runs | error {found.median:.3f} p95 {found.p95:.3f} max {found.largest:.2f} m, "
        f"yaw p95 {math.degrees(found.yaw_p95):.1f} deg | localized {found.localized:.2f} ambiguous "
        f"{found.ambiguous:.2f} (right among {found.near_while_ambiguous:.2f}) lost {found.lost:.2f} | first "
        f"{found.first_median:.1f} max {found.first_longest:.1f} m, after that {found.localized_after_first:.2f} | "
        f"wrong {found.wrong:.4f} in {list(found.wrong_runs)} | ms {found.ms_median:.1f} p99 {found.ms_p99:.0f}"
    )
    if not math.isnan(found.quiet_longest):
        text += (
            f" | kidnapped: quiet {found.quiet_longest:.1f}, again {found.again_median:.1f} max "
            f"{found.again_longest:.1f} m"
        )
    if math.isfinite(found.doubts_longest):
        text += f" | doubts the map after {found.doubts_longest:.1f} m"
    return text
