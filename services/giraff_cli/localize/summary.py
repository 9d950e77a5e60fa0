"""How a recording went through localization, in numbers."""

from __future__ import annotations

from textwrap import fill
from typing import Final

import msgspec

from giraff_cli.localize.recorded import RecordedDrive
from giraff_schemas.text import printable
from giraff_telemetry.localization_error import LocalizationErrors
from giraff_telemetry.localization_summary import (
    WIDTH,
    LocalizationSummary,
    localization_rows,
    summarize_localization,
)
from giraff_tools.terminal.text import json_page

_LABEL: Final = 15  # characters
_INDENT: Final = " " * (_LABEL + 2)


class Summary(msgspec.Struct, frozen=True, kw_only=True):
    """As `--json` prints it."""

    robot: str
    seconds: float
    """Of the recording."""
    factor: float
    """How many times faster than real time it went."""
    way_m: float
    """By odometry."""
    localization: LocalizationSummary
    doubt: str
    """Why the truth that the recording has says nothing of this map; empty: it does, or there is none."""


def summarize(drive: RecordedDrive, robot: str, *, took: float) -> Summary:
    """`took`: s that it has taken."""
    errors = LocalizationErrors() if drive.truth.doubt else drive.errors  # what was compared before the doubt is in it
    return Summary(
        robot=robot,
        seconds=round(drive.seconds, 3),
        factor=round(drive.seconds / took, 1) if took > 0.0 else 0.0,
        way_m=round(drive.way, 3),
        localization=summarize_localization(drive.policy.pose(), drive.shares, errors),
        doubt=drive.truth.doubt if drive.has_truth else "",
    )


def to_json(summary: Summary) -> str:
    return json_page(summary)


def to_text(summary: Summary) -> str:
    """For people."""
    rows = [
        ("recording", f"of {summary.robot}, {summary.seconds:.1f} s, {summary.factor:g} times faster than real time"),
        ("map", printable(summary.localization.map)),
        ("way", f"{summary.way_m:.2f} m by odometry"),
        *localization_rows(summary.localization),
    ]
    if summary.doubt:
        rows.append(("truth", fill(f"not told: {summary.doubt}", WIDTH)))
    indented = ((label, value.replace("\n", f"\n{_INDENT}")) for label, value in rows)
    return "\n".join(f"{label:>{_LABEL}}  {value}" for label, value in indented)
