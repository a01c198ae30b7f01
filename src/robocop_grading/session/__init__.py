"""A hand-in's node in the ordinary simulation, scenario by scenario. The ROS master is the session's own."""
