"""A hand-in's node in the ordinary simulation, scenario by scenario. The ROS master is in the node's process."""
