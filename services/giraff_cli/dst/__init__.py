"""`giraff dst`: deterministic simulation, many seeds."""
