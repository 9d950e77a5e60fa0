"""Floor plans from the turns of a laser scanner: how a turn is matched, and how many of them become a plan."""
