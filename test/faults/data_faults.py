"""Faults in the data that the server lives on: scan, odometry and clock of a robot made of messages."""

import math

import rospy
from faults import ANY, DONE, STOPPED, drive, fault
from system import wait_for


def _during(e, name, change, ticks):
    """Change messages during a goal, for ticks of these lengths [s]; `name` is odom or scan."""
    drive(e)
    setattr(e.stage, f"change_{name}", change)
    try:
        for length in ticks:
            e.stage.tick(length)
    finally:
        setattr(e.stage, f"change_{name}", lambda message: message)


# In lockstep the server waits up to a second of wall time for a message that is due, so few long ticks cost less.
LONG = (0.8, 0.8)  # together more than the server's data_timeout, each less
SHORT = (0.1,) * 5


@fault("data", needs="messages")
def scan_missing(e):
    """No scan."""
    _during(e, "scan", lambda message: None, LONG)
    return ("NO_SCAN", "REACHED")


@fault("data", needs="messages")
def odom_missing(e):
    """No odometry."""
    _during(e, "odom", lambda message: None, LONG)
    return ("NO_ODOM", "REACHED")


@fault("data", needs="messages")
def data_interrupted(e):
    """Neither scan nor odometry, for less than the timeout."""
    e.stage.change_scan = e.stage.change_odom = lambda message: None
    e.client.send_near(e.rng)
    e.stage.tick(0.5)
    e.stage.change_scan = e.stage.change_odom = lambda message: message
    return DONE


@fault("data", needs="messages")
def scan_of_values(e):
    """A scan in which all beams, or those ahead, hold one odd value."""
    value = e.rng.choice((math.nan, 0.0, -1.0, -math.inf, math.inf, 1e30, 1e-30))
    beams = e.rng.choice((range(360), range(-40, 41), range(-5, 6)))

    def change(message):
        for beam in beams:
            message.ranges[beam] = value
        return message

    _during(e, "scan", change, (*SHORT, *SHORT, *SHORT))
    return ("NO_SCAN", "REACHED", "OBSTACLE")


@fault("data", needs="messages")
def scan_of_wrong_length(e):
    """A scan with no, few or far too many beams, or angles that are none."""
    length = e.rng.choice((0, 1, 7, 5000))
    increment = e.rng.choice((None, 0.0, math.nan, math.inf, -1e30))

    def change(message):
        message.ranges = [math.inf] * length
        message.angle_increment = message.angle_increment if increment is None else increment
        return message

    _during(e, "scan", change, (*SHORT, *SHORT, *SHORT))
    return ANY


@fault("data", needs="messages")
def scan_without_directions(e):
    """A scan whose beams have no direction: all the same angle, none that is a number, or against angle_max."""
    change = e.rng.choice(
        (
            lambda scan: setattr(scan, "angle_increment", 0.0),
            lambda scan: setattr(scan, "angle_increment", math.nan),
            lambda scan: setattr(scan, "angle_min", math.inf),
            lambda scan: setattr(scan, "angle_increment", -scan.angle_increment),
        )
    )

    def changed(message):
        change(message)
        return message

    here = e.client.odom.pose.pose.position
    e.client.send(here.x + 5.0, here.y)
    e.stage.change_scan = changed
    try:
        for _ in range(20):
            e.stage.tick()
    finally:
        e.stage.change_scan = lambda message: message
    e.client.cancel()  # a goal that is still driving would end PREEMPTED
    return ("ERROR", "NO_SCAN")


@fault("data", needs="messages")
def odom_impossible(e):
    """Odometry with a pose that no robot can have."""
    value = e.rng.choice((math.nan, math.inf, 1e300, -1e300, 1e40))
    field = e.rng.choice(("x", "y", "orientation", "zeros"))

    def change(message):
        pose = message.pose.pose
        if field == "orientation":
            pose.orientation.z = value
        elif field == "zeros":
            pose.orientation.z = pose.orientation.w = 0.0
        else:
            setattr(pose.position, field, value)
        return message

    _during(e, "odom", change, SHORT)
    return ("ERROR", "REACHED")


@fault("data", needs="messages")
def odom_jumps(e):
    """Odometry that jumps through the plane."""

    def change(message):
        message.pose.pose.position.x += e.rng.uniform(-50.0, 50.0)
        return message

    _during(e, "odom", change, SHORT)
    return ("REACHED", "STUCK")


@fault("data", needs="messages")
def data_late(e):
    """Messages with stamps that are old, in the future or zero, or in other frames."""
    stamp = rospy.Time.from_sec(max(0.0, e.stage.now + e.rng.choice((-5.0, 5.0, -1e9))))
    frame = e.rng.choice(("", "elsewhere", "/odom", "a b"))

    def change(message):
        message.header.stamp, message.header.frame_id = stamp, frame
        return message

    _during(e, e.rng.choice(("odom", "scan")), change, LONG)
    return ANY


@fault("clock", needs="messages")
def clock_stalled(e):
    """The clock stands still during a goal, which is cancelled meanwhile."""
    goal = drive(e)
    if not e.client.results[goal]:
        e.client.cancel(goal)
        wait_for(lambda: e.client.results[goal], "the end of a cancelled goal while the clock stands")
    return STOPPED


@fault("clock", needs="messages")
def clock_set_forward_by_an_hour(e):
    """The clock is set forward by an hour during a goal."""
    drive(e)
    e.stage.set_time(e.stage.now + 3600.0)
    return (*STOPPED, "NO_ODOM", "NO_SCAN", "STUCK")


@fault("clock", needs="messages")
def clock_set_forward(e):
    """The clock is set forward during a goal."""
    drive(e)
    e.stage.set_time(e.stage.now + e.rng.choice((0.5, 10.0, 1e4)))
    return (*STOPPED, "NO_ODOM", "NO_SCAN", "STUCK")
