"""A rospy.Timer that an exception in its callback, or time moving backwards, can't kill silently."""

import traceback
from typing import Callable

import rospy


def start_timer(period: float, callback: Callable[[], None]) -> rospy.Timer:
    """Call `callback` every `period` [s] of ROS time; what it raises is logged, once in ten seconds, and it goes on."""

    def guarded(_event: rospy.timer.TimerEvent) -> None:
        try:
            callback()
        except rospy.ROSException as error:  # a topic closed under a publish: shutting down
            rospy.logdebug("timer callback: %s", error)
        except Exception:  # the timer's "main": rospy would end the thread without a word
            if not rospy.is_shutdown():
                rospy.logerr_throttle(10.0, "timer callback failed, the timer goes on:\n%s", traceback.format_exc())

    return rospy.Timer(rospy.Duration.from_sec(period), guarded, reset=True)
