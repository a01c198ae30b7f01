"""A rospy.Timer that survives exceptions in its callback and a clock that is set back."""

import traceback
from typing import Callable

import rospy


def start_timer(period: float, callback: Callable[[], None]) -> rospy.Timer:
    """Call `callback` every `period` [s] of ROS time; exceptions are logged, at most once in ten seconds."""

    def guarded(_event: rospy.timer.TimerEvent) -> None:
        try:
            callback()
        except rospy.ROSException as error:  # publishing on a topic that shutdown has closed
            rospy.logdebug("timer callback: %s", error)
        except Exception:  # the timer thread's outermost level: rospy would end the thread silently
            if not rospy.is_shutdown():
                rospy.logerr_throttle(10.0, "timer callback failed, the timer continues:\n%s", traceback.format_exc())

    return rospy.Timer(rospy.Duration.from_sec(period), guarded, reset=True)
