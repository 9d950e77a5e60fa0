"""The simulated camera: what it would see of the simulated room, in a process of its own."""
