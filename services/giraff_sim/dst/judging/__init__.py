"""Whether the robot keeps to the invariants: judged by the truth of hands, pins, world and disk, and by a ledger."""
