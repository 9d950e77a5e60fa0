"""A terminal that Rich draws on."""

from collections.abc import Iterator

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

from giraff_schemas.text import printable_lines


class CleanConsole(Console):
    """A console on which text of the network cannot steer the terminal: only Rich's own codes do."""

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterator[Segment]:
        for segment in super().render(renderable, options):
            is_sound = segment.control or segment.text.isprintable()
            yield segment if is_sound else Segment(printable_lines(segment.text), segment.style)
