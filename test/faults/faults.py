"""The faults of goals, time and world.

Each is a function of an episode; the words that its goals may end with are its return value.

A fault does its harm, undoes what would last, and returns: the campaign then waits for the ends of all goals, checks
the invariants and sends a goal that has to be reached.
"""

import math
import signal

import rospy
from aro_robocop_goto_as.srv import DeleteModel, MoveModel, SpawnModel
from dynamic_reconfigure.srv import Reconfigure
from geometry_msgs.msg import Pose
from stage import STRAY
from system import SIMULATOR, wait_for

ANY = None  # any ending
BAD = ("BAD_GOAL",)
DONE = ("REACHED",)
STOPPED = ("PREEMPTED", "REACHED")  # who cancels may be too late
BURST = 200
BOX = """<sdf version="1.6"><model name="block"><link name="link"><collision name="c"><geometry><box><size>
0.2 0.2 0.5</size></box></geometry></collision></link></model></sdf>"""


class Fault:
    """One kind of fault."""

    def __init__(self, run, group, needs="", costly=False):
        self.run, self.group, self.needs, self.costly = run, group, needs, costly
        self.name = run.__name__
        self.text = run.__doc__.rstrip(".")


FAULTS = []


def fault(group, needs="", costly=False):
    """Register a fault. `costly`: it takes seconds of wall time.

    `needs`: "simulator" or "messages", "bridge" (one robot), "last" (nothing goes
    on after it); empty: nothing.
    """

    def register(run):
        FAULTS.append(Fault(run, group, needs, costly))
        return run

    return register


def drive(e):
    """A goal during which the robot moves: its id, once it has given feedback."""
    goal = e.client.send_near(e.rng, 0.6)
    e.stage.wait_for(lambda: e.client.feedback[goal] or e.client.results[goal], f"feedback of {goal}")
    return goal


def place_apart(e):
    """A pose at which an obstacle is in no robot's way: farther from all robots than a goal that drive() sends."""
    robots = [e.stage.truth_of(client) for client in e.clients]
    pose = Pose()
    while True:
        pose.position.x = robots[0].x + e.rng.uniform(-4.0, 4.0)
        pose.position.y = robots[0].y + e.rng.uniform(-4.0, 4.0)
        if all(math.hypot(pose.position.x - at.x, pose.position.y - at.y) > 1.5 for at in robots):
            return pose


# -- goals --


@fault("goal")
def valid_goals(e):
    """One goal after another, without a fault."""
    for _ in range(e.rng.randint(1, 3)):
        e.client.send_near(e.rng)
        e.stage.wait_for(e.client.all_ended, "the end of a goal")
    return DONE


@fault("goal")
def goal_not_a_number(e):
    """A position of NaN or infinity."""
    bad = e.rng.choice((math.nan, math.inf, -math.inf))
    e.client.send(*e.rng.choice(((bad, 0.0), (0.0, bad), (bad, bad))))
    return BAD


@fault("goal")
def goal_out_of_reach(e):
    """A position beyond all bounds."""
    e.client.send(e.rng.choice((1e300, -1e39, 1e7)), e.rng.uniform(-1.0, 1.0))
    return BAD


@fault("goal")
def goal_odd_height(e):
    """A height that is no number, huge or below the floor."""
    e.client.send(*e.client.place_near(e.rng), z=e.rng.choice((math.nan, math.inf, 1e300, -5.0)))
    return DONE


@fault("goal")
def goal_here(e):
    """The position where the robot is."""
    here = e.client.odom.pose.pose.position
    e.client.send(here.x, here.y)
    return DONE


@fault("goal")
def goals_equal(e):
    """The same position several times."""
    place = e.client.place_near(e.rng)
    for _ in range(e.rng.randint(2, 5)):
        e.client.send(*place)
    return STOPPED


@fault("goal")
def goal_id_twice(e):
    """Two goals with one id."""
    first, second = e.client.place_near(e.rng), e.client.place_near(e.rng)
    goal = e.client.send(*first)
    if e.rng.random() < 0.5:
        e.stage.wait_for(lambda: e.client.feedback[goal], f"feedback of {goal}")
    with e.stage.standing_still():  # 5 s after its end actionlib forgets a goal: the second one would be a new one
        if not e.client.results[goal]:
            e.client.send(*second, goal_id=goal)
    return STOPPED


@fault("goal")
def goal_without_id(e):
    """A goal with an empty id, for which the server makes one."""
    known = set(e.client.results)
    e.client.send(*e.client.place_near(e.rng), goal_id="", expected=False)
    made = e.stage.wait_for(lambda: [goal for goal in list(e.client.results) if goal not in known], "its result")
    e.client.expected += made
    e.client.sent += 1
    return DONE


@fault("goal")
def goals_in_a_burst(e):
    """Many goals at once, some of them impossible."""
    for _ in range(e.rng.choice((10, 30, BURST)) if e.full else BURST // 2):
        bad = e.rng.random() < 0.1
        e.client.send(*((math.nan, 0.0) if bad else e.client.place_near(e.rng)))
    return (*STOPPED, *BAD)


@fault("goal")
def goal_stamp_odd(e):
    """A stamp in the past; actionlib refuses what follows one in the future."""
    stamp = rospy.Time.from_sec(max(0.0, e.stage.now - 5.0))
    e.client.send(*e.client.place_near(e.rng), stamp=stamp)
    e.client.send(*e.client.place_near(e.rng))
    return STOPPED


# -- cancels --


@fault("cancel")
def cancel_by_id(e):
    """A goal is cancelled by its id while the robot moves."""
    e.client.cancel(drive(e))
    return STOPPED


@fault("cancel")
def cancel_all(e):
    """All goals are cancelled right after they were sent."""
    for _ in range(e.rng.randint(1, 4)):
        e.client.send_near(e.rng)
    e.client.cancel()
    return STOPPED


@fault("cancel")
def cancel_by_stamp(e):
    """All goals up to a stamp are cancelled."""
    e.client.send(*e.client.place_near(e.rng), stamp=rospy.Time.from_sec(max(1e-3, e.stage.now - 1.0)))
    e.client.cancel(stamp=rospy.Time.from_sec(max(0.1, e.stage.now + e.rng.choice((-0.5, 0.0)))))
    return STOPPED


@fault("cancel")
def cancel_before_goal(e):
    """A cancel overtakes its goal."""
    goal = f"early-{e.name}"
    e.client.cancel(goal)
    e.client.send(*e.client.place_near(e.rng), goal_id=goal)
    return STOPPED


@fault("cancel")
def cancel_what_never_was(e):
    """A cancel of an unknown id, and several of one goal."""
    goal = drive(e)
    e.client.cancel("nobody's")
    for _ in range(e.rng.randint(0, 3)):
        e.client.cancel(goal)
    return STOPPED


# -- time, pose and world --


@fault("time", needs="simulator")
def pause_during_goal(e):
    """Simulated time stands still during a goal, which may be cancelled meanwhile."""
    goal = drive(e)
    e.stage.call("pause")
    if e.rng.random() < 0.5:
        e.client.cancel(goal)
        wait_for(lambda: e.client.results[goal], "the cancelled goal's end while paused")
    e.stage.call("unpause")
    return STOPPED


@fault("time", needs="simulator")
def step_during_goal(e):
    """Somebody steps the simulator during a goal."""
    drive(e)
    for _ in range(e.rng.randint(1, 3)):
        e.stage.step(e.rng.choice((0.0, 0.01, 0.1, 0.35)))
    e.stage.call("unpause")
    return STOPPED


@fault("time", needs="simulator")
def reset_during_goal(e):
    """The simulator is reset during a goal."""
    drive(e)
    e.stage.reset()
    return ("REACHED",)


@fault("time", needs="simulator")
def speed_changes_during_goal(e):
    """The real-time factor changes during a goal, also to an impossible value."""
    drive(e)
    service = rospy.ServiceProxy(f"/{SIMULATOR}/set_parameters", Reconfigure)
    for factor in (e.rng.choice((-1.0, math.nan, 50.0)), e.factor):
        request = Reconfigure._request_class()
        request.config.doubles = [_double("real_time_factor", factor)]
        service(request)
    return STOPPED


def _double(name, value):
    from dynamic_reconfigure.msg import DoubleParameter

    return DoubleParameter(name, value)


@fault("world", needs="simulator")
def set_pose_during_goal(e):
    """The robot is placed elsewhere during a goal, or where it or another robot is."""
    drive(e)
    home_x, home_y = e.stage.homes[e.client]
    for _ in range(e.rng.randint(1, 3)):
        robot = e.stage.truth_of(e.rng.choice(e.clients))
        near = (home_x + e.rng.uniform(-STRAY, STRAY), home_y + e.rng.uniform(-STRAY, STRAY))
        e.stage.set_pose(e.client.namespace, *e.rng.choice((near, near, (robot.x, robot.y))))
    return ANY


@fault("world", needs="simulator")
def world_edited_during_goal(e):
    """Models appear, move and disappear during a goal."""
    drive(e)
    spawn, move, delete = (
        rospy.ServiceProxy(f"/{SIMULATOR}/{name}", kind)
        for name, kind in (("spawn_model", SpawnModel), ("move_model", MoveModel), ("delete_model", DeleteModel))
    )
    pose = place_apart(e)
    spawn("block", BOX, "", pose)
    spawn("block", BOX, "", pose)
    if e.rng.random() < 0.5:
        pose = place_apart(e)
    else:
        pose.position.x = e.rng.choice((math.nan, 1e300))
    move("block", pose)
    spawn("broken", "<sdf><model", "", Pose())
    delete("nothing")
    delete("block")
    return STOPPED


@fault("world", needs="simulator")
def obstacle_appears(e):
    """A wall of blocks appears around the robot during a goal."""
    goal = drive(e)
    truth = e.stage.truth_of(e.client)
    spawn = rospy.ServiceProxy(f"/{SIMULATOR}/spawn_model", SpawnModel)
    for number in range(4):
        pose, angle = Pose(), number * math.pi / 2.0
        pose.position.x, pose.position.y = truth.x + 0.45 * math.cos(angle), truth.y + 0.45 * math.sin(angle)
        spawn(f"block_{number}", BOX, "", pose)
    e.stage.wait_for(lambda: e.client.results[goal], "the goal's end")
    delete = rospy.ServiceProxy(f"/{SIMULATOR}/delete_model", DeleteModel)
    for number in range(4):
        delete(f"block_{number}")
    return ("REACHED", "OBSTACLE", "STUCK")


@fault("process", needs="last", costly=True)
def master_killed(e):
    """SIGKILL of the ROS master: what is connected goes on."""
    goal = drive(e)
    e.system.end("master", signal.SIGKILL)
    e.system.processes.pop("master")
    e.stage.wait_for(lambda: e.client.results[goal], "the goal's end without a master")
    return DONE
