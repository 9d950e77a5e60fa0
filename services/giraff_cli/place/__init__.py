"""`giraff place`: places by name, and lines that no route crosses."""
