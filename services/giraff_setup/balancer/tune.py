"""`giraff tune balance`: gains from masses, inertias and lengths of a robot file, beside those that the file has."""

import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from giraff_base.drives.balancer.config import BalancingBody
from giraff_base.drives.balancer.setup import DELAYS, LEASH, MARGIN, PERIOD, Gains, Loop, respond
from giraff_core.bounds import check_bounds
from giraff_node.config.robot_file import ConfigError, read
from giraff_schemas.checks import converted
from giraff_tools.network.command import print_error
from giraff_tools.terminal.dots import draw_curves, takes_dots
from giraff_tools.terminal.output import guard_stdout
from giraff_tools.terminal.page import print_json

STEP: Final = LEASH
"""m. The board lets the held place be no farther away."""
SECONDS: Final = 8.0
_ARRIVED: Final = 0.1  # of the step: it stays within
Matrix = NDArray[np.float64]

_COSTS_ONE: Final = (0.03, 0.35, 0.10, 0.30)
"""rad, rad/s, m, m/s that cost one unit."""
_TORQUE_COSTS_ONE: Final = 14.0  # N m
_DOUBLINGS: Final = 16  # 2^16 periods, 5 minutes: the gains do not change any more


class Response(NamedTuple):
    """What a robot does that stands and is to hold another place."""

    way: list[float]
    """m from where it stood, for each period."""
    lean: float
    """rad. Largest one."""
    torque: float
    """N m. Largest one."""

    @property
    def settled(self) -> float | None:
        """Return the s after which it stays within a tenth of the step. None: it does not."""
        late = [at for at, way in enumerate(self.way, 1) if abs(way - STEP) > _ARRIVED * STEP]
        return None if late and late[-1] == len(self.way) else (late[-1] if late else 0) * PERIOD


def respond_to_step(body: BalancingBody, gains: Gains) -> Response:
    """Return the response to a step of the held place: the linear body, the longest delay and a bounded torque."""
    moments = respond(body.mechanics, gains, body.torque_max, way=-STEP)
    kept = [next(moments) for _ in range(round(SECONDS / PERIOD))]
    return Response(
        way=[each.way + STEP for each in kept],
        lean=max(abs(each.lean) for each in kept),
        torque=max(abs(each.torque) for each in kept),
    )


_NAMES: Final = Gains._fields
_BALANCER: Final = "balancer"
_FARTHEST: Final = 1000.0  # times all gains: nothing beyond is searched
_HALVINGS: Final = 40


class FiledBody(BalancingBody, frozen=True, kw_only=True):
    """What of `[base.drive]` gains are computed from, and its gains, which may be missing or wrong."""

    k1: float | None = None
    k2: float | None = None
    k3: float | None = None
    k4: float | None = None

    def __post_init__(self) -> None:
        check_bounds(self)

    @property
    def gains(self) -> Gains | None:
        """Return the four gains. None: one is missing."""
        k1, k2, k3, k4 = self.k1, self.k2, self.k3, self.k4
        return None if k1 is None or k2 is None or k3 is None or k4 is None else Gains(k1, k2, k3, k4)


def tune_balance(file: Path | None, *, as_json: bool) -> int:
    """Return the exit code of the whole command. `as_json`: print the gains and what they do as one document."""
    environment = os.environ if file is None else {**os.environ, "GIRAFF_CONFIG": str(file)}
    try:
        settings = read(environment)
    except ConfigError as error:
        return print_error(str(error))
    try:
        body = _body(settings.tables.get("base", {}).get("drive"))
    except ValueError as error:
        return print_error(f"{settings.place('base')}: {error}")

    def report() -> int:
        if as_json:
            print_json(
                {
                    "robot_file": settings.where,
                    **{name.replace(" ", "_"): judged(body, gains) for name, gains in rows_of(body).items()},
                }
            )
            return 0
        for line in told(settings.where, body, dots=takes_dots()):
            print(line)
        return 0

    return guard_stdout(report)


def rows_of(body: FiledBody) -> dict[str, Gains]:
    """Return the computed gains, and those of the file where they are others."""
    computed = Gains(*(float(f"{gain:.4g}") for gain in gains_of(body)))
    filed = body.gains
    return (
        {"computed": computed} if filed is None or filed == computed else {"computed": computed, "in the file": filed}
    )


def judged(body: FiledBody, gains: Gains) -> dict[str, Any]:
    """Return the gains and what a robot does with them: m, rad, s and N m."""
    loop = Loop(body.mechanics, gains)
    response = respond_to_step(body, gains) if loop.holds() else None
    return {
        **gains._asdict(),
        "holds": loop.holds(),
        "has_margin": loop.has_margin,
        "step": STEP,
        "settled": response and response.settled,
        "lean": response and response.lean,
        "torque": response and response.torque,
    }


def told(where: str, body: FiledBody, *, dots: bool) -> Iterator[str]:
    """Return the lines of the report."""
    rows = rows_of(body)
    computed = rows["computed"]
    is_same = ", and those of the file are the same" if body.gains == computed else ""
    yield f"{where}: gains computed from the physics{is_same}"
    yield ""
    yield f"{'':12}{'k1':>10}{'k2':>10}{'k3':>10}{'k4':>10}"
    for name, gains in rows.items():
        yield f"{name:12}" + "".join(f"{gain:10g}" for gain in gains)
    yield ""
    for name, gains in rows.items():
        yield f"{name}: {_margin(body, gains)}"
        if Loop(body.mechanics, gains).holds():
            yield f"{'':{len(name) + 2}}{_step(respond_to_step(body, gains))}"
    yield ""
    yield f"a step of {STEP * 100:g} cm with the computed gains, in cm:"
    yield from _drawn(respond_to_step(body, computed), dots=dots)
    yield ""
    yield "try them while it stands, held by a rope; they count until base restarts:"
    yield from (f"    giraff param set base.drive.{name} {gain:g}" for name, gain in zip(_NAMES, computed, strict=True))
    yield "keep them in the robot file:"
    yield "    [base.drive]"
    yield from (f"    {name} = {float(gain)}" for name, gain in zip(_NAMES, computed, strict=True))


def _body(drive: Any) -> FiledBody:
    kind = drive.get("type") if isinstance(drive, dict) else None
    if kind != _BALANCER:
        raise ValueError(f"drive.type is {kind!r}: only for '{_BALANCER}' there are gains to compute; name its file")
    return converted(drive, FiledBody, strict=False)


def _margin(body: BalancingBody, gains: Gains) -> str:
    loop = Loop(body.mechanics, gains)
    if not loop.holds():
        return "the robot falls"
    spans = [f"{_edge(loop, delay, 1 / _FARTHEST):.2g} to {_edge(loop, delay, _FARTHEST):.2g}" for delay in DELAYS]
    unsafe = "" if loop.has_margin else f"; base refuses them: it asks for {MARGIN[0]:.2g} to {MARGIN[-1]:.2g}"
    return f"it stands with all four times {', '.join(spans)} at 1, 2, 3 periods of delay{unsafe}"


def _edge(loop: Loop, delay: int, farthest: float) -> float:
    """Return the last factor on all gains that holds the robot, on the way to `farthest`."""
    holds, falls = 0.0, math.log(farthest)
    if loop.holds(farthest, (delay,)):
        return farthest
    for _ in range(_HALVINGS):
        middle = (holds + falls) / 2
        holds, falls = (middle, falls) if loop.holds(math.exp(middle), (delay,)) else (holds, middle)
    return math.exp(holds)


def _step(response: Response) -> str:
    settled = response.settled
    arrives = "does not arrive" if settled is None else f"stays within 5 mm after {settled:.1f} s"
    return (
        f"a step of {STEP * 100:g} cm: it {arrives}, leans by {math.degrees(response.lean):.1f} degrees and takes "
        f"{response.torque:.1f} N m at most"
    )


def _drawn(response: Response, *, dots: bool) -> Iterator[str]:
    way = [each * 100.0 for each in response.way]  # cm
    return draw_curves([way], min(*way, 0.0), max(*way, STEP * 100.0), SECONDS, dots=dots)


def gains_of(body: BalancingBody, period: float = PERIOD) -> Gains:
    """Return the gains of the linear-quadratic regulator, sampled each `period` s."""
    a, b = sampled(body, period)
    cost = np.diag(1.0 / np.square(_COSTS_ONE))
    effort = np.array([[1.0 / _TORQUE_COSTS_ONE**2]])
    price = _riccati(a, b, cost, effort)
    gains = -np.linalg.solve(effort + b.T @ price @ b, b.T @ price @ a)
    return Gains(*map(float, gains.ravel()))


def sampled(body: BalancingBody, period: float = PERIOD) -> tuple[Matrix, Matrix]:
    """Return what a state and a torque become in one period, of a body near upright."""
    a, b = body.mechanics.sampled(period)
    return np.array(a), np.array(b)[:, np.newaxis]


def _riccati(a: Matrix, b: Matrix, cost: Matrix, effort: Matrix) -> Matrix:
    """Solve the discrete Riccati equation by doubling the horizon (Chu and others, Int J Control 77, 2004)."""
    reach = b @ np.linalg.solve(effort, b.T)
    price = cost
    for _ in range(_DOUBLINGS):
        middle = np.linalg.inv(np.eye(len(a)) + reach @ price)
        a, reach, price = a @ middle @ a, reach + a @ middle @ reach @ a.T, price + a.T @ price @ middle @ a
    return price
