"""Everything that uses rospy: thin nodes around the core."""
