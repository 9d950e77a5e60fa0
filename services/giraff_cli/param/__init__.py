"""`giraff param`: list, get, describe, set, save."""
