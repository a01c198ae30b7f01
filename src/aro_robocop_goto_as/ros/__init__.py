"""All of rospy: thin nodes around the core."""
