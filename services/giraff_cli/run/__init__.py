"""`giraff run`: the simulated robot and its services."""
