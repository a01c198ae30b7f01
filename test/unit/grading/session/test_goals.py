"""The table of a bridge's goals tells of them as actionlib's server does."""

import pytest
import rospy
from actionlib_msgs.msg import GoalID, GoalStatus
from aro_robocop_goto_as.msg import GoToPositionActionGoal, GoToPositionResult

from robocop_grading.session.goals import KEPT, Goals


class Table(Goals):
    """With what has been published last, and a time of its own."""

    def __init__(self):
        self.now, self.last = rospy.Time(100), {}
        super().__init__(lambda topic, message: self.last.update({topic.rpartition("/")[2]: message}), lambda: self.now)

    def states(self):
        return [(it.goal_id.id, it.status) for it in self.last["status"].status_list]


def goal(name, stamp=50):
    return GoToPositionActionGoal(goal_id=GoalID(rospy.Time(stamp), name))


@pytest.fixture
def table():
    return Table()


def test_a_goal_goes_from_pending_to_its_end_and_is_forgotten_some_time_later(table):
    assert table.add(goal("a")) == GoalStatus.PENDING and table.add(goal("a")) is None
    table.publish_status()
    assert table.states() == [("a", GoalStatus.PENDING)]
    table.accept("a")
    assert table.states() == [("a", GoalStatus.ACTIVE)] and table.last["feedback"].status.goal_id.id == "a"
    table.finish("a", GoalStatus.SUCCEEDED)
    assert table.states() == [("a", GoalStatus.SUCCEEDED)] and table.last["result"].result.success
    table.now += KEPT + rospy.Duration(1)
    table.publish_status()
    assert table.states() == []


@pytest.mark.parametrize("end", [GoalStatus.ABORTED, GoalStatus.PREEMPTED])
def test_a_goal_that_ends_without_success_has_a_result_that_says_so(end, table):
    table.add(goal("a"))
    table.accept("a")
    table.finish("a", end)
    assert table.states() == [("a", end)] and not table.last["result"].result.success


@pytest.mark.parametrize("accepted, end", [(True, GoalStatus.PREEMPTED), (False, GoalStatus.RECALLED)])
@pytest.mark.parametrize("request_", [GoalID(id="a"), GoalID(), GoalID(stamp=rospy.Time(60))])
def test_a_goal_that_is_cancelled_ends_by_whether_it_was_accepted(request_, accepted, end, table):
    table.add(goal("a"))
    if accepted:
        table.accept("a")
    assert table.request_cancel(request_) == ["a"] and table.request_cancel(request_) == []
    table.cancel("a", GoToPositionResult(False, "cancelled"))
    assert table.last["result"].status.status == end


def test_goals_without_an_id_get_one_each_and_the_time_of_their_arrival(table):
    first, second = (table.identified(GoalID()) for _ in range(2))
    assert first.id != second.id and first.stamp == table.now
    given = GoalID(rospy.Time(50), "a")
    assert table.identified(given) == given


def test_a_goal_that_was_cancelled_before_it_came_is_recalled(table):
    table.request_cancel(GoalID(id="a"))
    assert table.add(goal("a")) == GoalStatus.RECALLED and table.states() == [("a", GoalStatus.RECALLED)]
    table.request_cancel(GoalID(stamp=rospy.Time(70)))
    assert table.add(goal("b")) == GoalStatus.RECALLED and ("b", GoalStatus.RECALLED) in table.states()
    assert table.add(goal("c", 80)) == GoalStatus.PENDING


def test_a_request_for_all_goals_spares_those_that_are_named_and_one_for_a_goal_does_not(table):
    for name in ("a", "b"):
        table.add(goal(name))
    assert table.request_cancel(GoalID(), spared={"b"}) == ["a"]
    assert table.states() == [("a", GoalStatus.RECALLING), ("b", GoalStatus.PENDING)]
    assert table.request_cancel(GoalID(id="b"), spared={"b"}) == ["b"]
