"""The resource limits of this process (setrlimit)."""

import resource

ENOUGH = 65_536  # file descriptors; in containers the system may grant a billion, over which some libraries loop


def raise_descriptor_limit() -> None:
    """Allow this process as many file descriptors as the system grants, up to ENOUGH.

    Each subscriber of each topic takes two. The usual limit of 1024 is there for programs that call select(), and too
    low for a recorder, RViz and controllers of 50 robots; rospy accepts no more subscribers once it was reached.
    """
    now, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    granted = ENOUGH if most == resource.RLIM_INFINITY else min(most, ENOUGH)
    if now < granted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (granted, most))
