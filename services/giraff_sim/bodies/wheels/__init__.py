"""A body on two driven wheels. It is in its safe state when neither motor has power."""
