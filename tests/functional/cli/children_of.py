"""A parent for the supervision's tests: starts the named stand-ins and waits to be killed.

    python children_of.py DIRECTORY MODULE...

The modules are found beside DIRECTORY's logs. Prints their process ids in one line.
"""

import os
import sys
import time
from pathlib import Path

from giraff_cli.run.processes import ProcessGroup

if __name__ == "__main__":
    directory, *modules = sys.argv[1:]
    children = ProcessGroup(Path(directory))
    for module in modules:
        children.start(module, module, [], os.environ | {"PYTHONPATH": directory})
    print(*(children.pid(module) for module in modules), flush=True)
    time.sleep(600.0)
