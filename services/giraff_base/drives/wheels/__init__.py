"""Two driven wheels on the firmware `firmware/base`. The safe state is a motor without power."""
