"""The senses of the guard: what each kind of sensor tells of the way, one a file or folder."""
