"""`giraff play`: publish a recording again."""
