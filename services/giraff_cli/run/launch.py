"""Becomes a command that cannot outlive the process that started it.

    python -I -S launch.py PARENT_PID COMMAND...

The kernel kills what this becomes when its parent's main thread, which must have started it, ends for any reason.
The wish survives the exec, so that the command need not know. Stands alone: it imports nothing of this package.
"""

import ctypes
import os
import signal
import sys

_PR_SET_PDEATHSIG = 1

if __name__ == "__main__":
    if ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0) != 0:
        sys.exit(f"prctl: {os.strerror(ctypes.get_errno())}")
    if os.getppid() != int(sys.argv[1]):
        sys.exit("the parent has ended already")
    os.execv(sys.argv[2], sys.argv[2:])  # noqa: S606
