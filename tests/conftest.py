"""Of all tests."""

import os

from hypothesis import settings

pytest_plugins = ["tests.support.budget"]

# Read by numpy and OpenCV when they are imported. On small matrices and pictures, threads that wait for each other take
# more processor time than the sums, and what they add up may differ by the number of cores.
for threads in ("OPENBLAS_NUM_THREADS", "OPENCV_FOR_THREADS_NUM"):
    os.environ.setdefault(threads, "1")

# How long one example takes says more of this machine than of the code; pytest's own time-out ends what hangs.
settings.register_profile("giraff", deadline=None)
settings.load_profile("giraff")
