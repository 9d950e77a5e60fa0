"""`giraff topic`: list, info, echo, hz, bw, pub."""
