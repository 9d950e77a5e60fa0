"""`giraff top`: the load of each process."""
