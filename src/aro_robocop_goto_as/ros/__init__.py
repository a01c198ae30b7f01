"""Everything that uses rospy: thin nodes around the core."""

from . import lean_imports

lean_imports.prepare()
