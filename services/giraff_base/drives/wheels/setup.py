"""Parts of the wheels' drive that their bench uses: the frames to the board, and whether it drives by levels."""

from giraff_base.drives.wheels.commands import WheelsCommands
from giraff_base.drives.wheels.config import by_levels

__all__ = ["WheelsCommands", "by_levels"]
