"""The ultrasonic sensors: what each is believed to say, one rule a file."""
