"""The simulator's control socket: what a test or a run asks of a running world."""
