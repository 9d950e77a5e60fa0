"""Steps from a new robot to one that drives, and which of them are done."""
