"""`giraff map convert`: a room as an occupancy grid."""

from pathlib import Path

from giraff_maps.floor_plan import MapError
from giraff_maps.grid_write import write_grid
from giraff_tools.network.command import print_error
from giraff_tools.terminal.output import guard_stdout
from giraff_tools.terminal.page import print_json


def convert(room: Path, out: Path, resolution: float, *, as_json: bool = False) -> int:
    """The exit code."""
    try:
        image = write_grid(room, out, resolution)
    except MapError as error:
        return print_error(str(error))
    except OSError as error:
        return print_error(f"{error.filename or out}: cannot be written: {error.strerror or error}; name another file")

    def report() -> int:
        if as_json:
            print_json({"file": str(out), "image": str(image), "resolution": resolution})
            return 0
        print(f"{out} and {image}, by cells of {resolution:g} m")
        return 0

    return guard_stdout(report)
