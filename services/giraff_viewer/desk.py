"""How the screen is laid out."""

from collections.abc import Sequence

import rerun.blueprint as rrb

from giraff_viewer.pictures import picture_path
from giraff_viewer.plots import BALANCE_PLOTS, BALANCE_PWM, PLOTS
from giraff_viewer.rows import FLOOR
from giraff_viewer.scene import GUARD, HAND, LOG

TIMELINE = "time"
"""When it was heard, by the wall clock of whoever heard it."""


LIVE_WINDOW = 60.0
"""s that the lines of a live robot go back: more cannot be told apart, and takes longer to draw."""


def blueprint(*, live: bool, balances: bool = False, cameras: Sequence[str] = (), still: bool = False) -> rrb.Blueprint:
    """The newest moment is followed until somebody looks back. `balances`: with the plots of a robot that does.

    `cameras`: those with pictures, which stand above the floor. `still`: for a picture, without the viewer's menu.
    """
    titles = {plot: title for plot, (title, _) in (BALANCE_PLOTS | PLOTS if balances else PLOTS).items()}
    if balances:
        titles["pwm"] = BALANCE_PWM
    floor = rrb.Spatial2DView(origin=FLOOR, name="floor")
    hand = rrb.Spatial2DView(
        origin=HAND, name="hand, g", visual_bounds=rrb.VisualBounds2D(x_range=[-1.1, 1.1], y_range=[-1.1, 1.1])
    )
    words = rrb.TextDocumentView(origin=GUARD, name="guard and base")
    log = rrb.TextLogView(origin=LOG, name="log", columns=rrb.TextLogColumns(text_log_columns=["LogLevel", "Body"]))
    plots = [
        rrb.TimeSeriesView(
            origin=f"plots/{plot}",
            name=title,
            plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftTop),
            time_ranges=_of_late() if live else None,
            axis_x=rrb.TimeAxis(view_range=_late()) if still else None,
        )
        for plot, title in titles.items()
    ]
    below = rrb.Horizontal(hand, words, column_shares=[1, 3])
    eyes = [rrb.Horizontal(*map(camera_view, cameras))] if cameras else []
    left = rrb.Vertical(*eyes, floor, below, row_shares=[4, 5, 3] if eyes else [5, 3])
    right = rrb.Vertical(rrb.Grid(*plots, grid_columns=2), log, row_shares=[5 if balances else 4, 1])
    return _desk(rrb.Horizontal(left, right, column_shares=[1, 1]), still=still)


def camera_blueprint(camera: str) -> rrb.Blueprint:
    """What a camera sees, and nothing else."""
    return _desk(camera_view(camera))


def _desk(shown: rrb.Horizontal | rrb.View, *, still: bool = False) -> rrb.Blueprint:
    return rrb.Blueprint(
        shown,
        rrb.TopPanel(state="hidden" if still else "expanded"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="following"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        auto_views=False,
        auto_layout=False,
    )


def camera_view(camera: str) -> rrb.Spatial2DView:
    """Return what shows the pictures of a camera."""
    return rrb.Spatial2DView(origin=picture_path(camera), name=f"camera {camera}")


def _of_late() -> rrb.VisibleTimeRange:
    late = _late()
    return rrb.VisibleTimeRange(TIMELINE, start=late.start, end=late.end)


def _late() -> rrb.TimeRange:
    since = rrb.TimeRangeBoundary.cursor_relative(seconds=-LIVE_WINDOW)
    return rrb.TimeRange(start=since, end=rrb.TimeRangeBoundary.cursor_relative(seconds=0.0))
