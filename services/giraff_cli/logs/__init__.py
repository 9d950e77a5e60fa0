"""`giraff logs`: the words of this host's services, in order of time."""
