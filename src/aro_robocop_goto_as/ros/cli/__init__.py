"""Commands that start or talk to a ROS system: goto, launch."""
