"""Limits of this process."""

import resource


def raise_descriptor_limit() -> None:
    """Allow this process all the file descriptors that the system grants it.

    Each subscriber of each topic takes two. The usual limit of 1024 is there for programs that call select(), and too
    low for a recorder, RViz and controllers of 50 robots; rospy accepts no more subscribers once it was reached.
    """
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
