"""Of all tests."""

from hypothesis import settings

pytest_plugins = ["tests.support.budget"]

# How long one example takes says more of this machine than of the code; pytest's own time-out ends what hangs.
settings.register_profile("giraff", deadline=None)
settings.load_profile("giraff")
