"""Places by name and no-go lines on the floor plan, kept in a file beside it, and the routes between them."""
