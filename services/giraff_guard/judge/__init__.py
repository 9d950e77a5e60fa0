"""What is true of all senses: the limits that follow from what they tell."""
