"""The grader's master calls nodes at once, and tells when it has called them all."""

import threading

from rosmaster.master_api import ROSMasterHandler
from waiting import wait_for

from robocop_grading.session import ros_internals


def test_master_calls_nodes_in_order_and_tells_when_all_are_called():
    master = ROSMasterHandler(3)
    old = master.thread_pool
    ros_internals.update_at_once(master)
    assert old.get_thread_count() == 0 and master.reg_manager.thread_pool is master.thread_pool
    may_return, called = threading.Event(), []
    master.thread_pool.queue_task("node", lambda topic: called.append(topic) or may_return.wait(), ("first",))
    master.thread_pool.queue_task("node", called.append, ("second",))
    wait_for(lambda: called == ["first"], "called")
    assert not ros_internals.all_updated()
    may_return.set()
    wait_for(ros_internals.all_updated, "told that all are called")
    assert called == ["first", "second"]
