"""Places by name and no-go lines on the floor plan: kept in a file beside the plan, and told to the network."""
