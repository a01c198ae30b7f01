"""One sensor a module: RobotState -> measurement, with seeded noise."""
