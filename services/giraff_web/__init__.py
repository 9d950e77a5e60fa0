"""The web service: a page from which a person drives, sees and stops the robot, in any browser of the network."""
