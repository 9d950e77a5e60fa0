"""Where pictures come from: a camera of the kernel's, or the simulated one."""
