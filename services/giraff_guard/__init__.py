"""The only way to the motors: passes an operator's command on as far as it is fresh and the way is free."""
