"""`giraff move`, `turn`, `arc` and `go`: motions by metres and degrees."""
