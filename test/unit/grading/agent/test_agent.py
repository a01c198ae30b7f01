"""Programs under the agent live in simulated time."""

import os
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from agent_program import AGENT, PATIENCE, STEP, Program
from waiting import wait_for


def printed(folder, text, seconds=20.0):
    with Program(folder, text) as program:
        return program.output(seconds)


AFTER = "round(time.monotonic() - start, 6)"
POLL = (
    "import select, socket, threading; s, p = socket.socketpair(), select.poll()\n"
    "threading.Timer(0.4, s[1].send, [b'x']).start()\n"
)


@pytest.mark.parametrize(
    "text, expected",
    [
        ("time.sleep(0.25)", 0.25),
        ("import threading; threading.Event().wait(1.5)", 1.5),
        ("import threading; lock = threading.Lock(); lock.acquire(); lock.acquire(timeout=0.2)", 0.2),
        ("import threading; t = threading.Thread(target=time.sleep, args=(2.0,)); t.start(); t.join()", 2.0),
        ("import threading; t = threading.Thread(target=time.sleep, args=(2.0,)); t.start(); t.join(0.5)", 0.5),
        ("import threading; e = threading.Event(); threading.Timer(0.7, e.set).start(); e.wait(5.0)", 0.7),
        ("import queue\ntry: queue.Queue().get(timeout=0.4)\nexcept queue.Empty: pass", 0.4),
        ("import queue\ntry: queue.SimpleQueue().get(timeout=0.4)\nexcept queue.Empty: pass", 0.4),
        ("import select; select.select([], [], [], 0.6)", 0.6),
        ("import select, socket; s = socket.socketpair(); select.select([s[0]], [], [], 0.6)", 0.6),
        ("import select, socket; s = socket.socketpair(); p = select.poll(); p.register(s[0], 1); p.poll(300)", 0.3),
        (f"{POLL}p.register(s[0], 0); p.modify(s[0], 1); p.poll(2000)", 0.4),
        ("import select, socket; s = socket.socketpair(); e = select.epoll(); e.register(s[0], 1); e.poll(0.3)", 0.3),
        ("import socket; s = socket.socketpair(); s[0].settimeout(0.2)\ntry: s[0].recv(1)\nexcept OSError: pass", 0.2),
        ("import socket; s = socket.socketpair()[0]; s.close()\ntry: s.recv(1)\nexcept OSError: time.sleep(0.2)", 0.2),
        ("import asyncio\nasync def f():\n    for _ in range(100): await asyncio.sleep(0.1)\nasyncio.run(f())", 10.0),
        ("import rospy; rospy.rostime.wallsleep(0.1)", 0.1),
        ("while time.monotonic() - start < 0.2005: pass", 0.201),
        ("end = time.time() + 0.2005\nwhile time.time() < end: pass", 0.201),
        ("from multiprocessing import Pipe; ends = Pipe()\nfor _ in range(1000): ends[0].poll()", 0.05),
    ],
)
def test_every_way_to_wait_takes_simulated_time(text, expected, tmp_path):
    assert float(printed(tmp_path, f"{text}\nprint({AFTER})")[-1]) == pytest.approx(expected, abs=0.011)


OLD_NUMPY = "inf nan 1.5 True (1, 2)"


@pytest.mark.parametrize(
    "text, expected",
    [
        ("import numpy as np; print(np.zeros(1, np.float).astype(np.int).dtype == int)", "True"),
        ("import numpy as np; print(np.Inf, np.NaN, np.float_(1.5), np.alltrue([1]), np.mat('1 2').shape)", OLD_NUMPY),
        ("import threading; print(threading.Thread().isAlive())", "False"),
        ("from collections import Iterable; print(isinstance([], Iterable))", "True"),
        ("import yaml; print(yaml.load('a: 1.5'))", "{'a': 1.5}"),
    ],
)
def test_what_the_labs_older_versions_have_works(text, expected, tmp_path):
    assert printed(tmp_path, text)[-1] == expected


def test_time_stands_still_while_the_program_works(tmp_path):
    text = f"for number in range(10**6): pass\nprint({AFTER}, time.time() > 1.6e9)"
    assert printed(tmp_path, text, 0.5)[-1] == "0.0 True"


def test_clocks_are_rounded_alike_in_every_run_and_show_the_time_of_day(tmp_path):
    text = "print(time.monotonic_ns(), time.time_ns() % 10**9, time.time())"
    monotonic, fraction, now = map(float, printed(tmp_path, text)[-1].split())
    assert (monotonic, fraction) == (2**14 * 1e9, 0.0) and now <= time.time() < now + PATIENCE


def test_datetime_follows_simulated_time_and_is_otherwise_itself(tmp_path):
    text = (
        "import pickle\nfrom datetime import datetime, timezone\n"
        "a, b, c = datetime.now(), datetime.utcnow(), datetime.now(timezone.utc)\ntime.sleep(2.5)\n"
        "passed = datetime.today() - a, datetime.utcnow() - b, datetime.now(timezone.utc) - c\n"
        "print([round(it.total_seconds(), 3) for it in passed], pickle.loads(pickle.dumps(a)) == a)\n"
        "import rospy, numpy\nprint(isinstance(numpy.datetime64('2026-01-01T00:00:00').item(), datetime), datetime)\n"
    )
    assert printed(tmp_path, text)[-2:] == ["[2.5, 2.5, 2.5] True", "True <class 'datetime.datetime'>"]


def test_lock_refuses_a_negative_timeout_as_pythons_own_does(tmp_path):
    text = "import threading\ntry: threading.Lock().acquire(timeout=-5)\nexcept ValueError: print('refused')"
    assert printed(tmp_path, text) == ["refused"]


def test_threads_meet_at_the_same_times_in_every_run(tmp_path):
    text = (
        "import queue, threading\nq = queue.Queue()\n"
        "def produce(period):\n    for _ in range(5):\n        time.sleep(period); q.put(period)\n"
        "for period in (0.1, 0.15): threading.Thread(target=produce, args=(period,)).start()\n"
        f"print([(q.get(), {AFTER}) for _ in range(10)])"
    )
    (line,) = printed(tmp_path, text)
    times = [0.1, 0.15, 0.2, 0.3, 0.3, 0.4, 0.45, 0.5, 0.6, 0.75]
    assert [entry[1] for entry in eval(line)] == times


def test_agent_tells_when_the_program_will_wake_up(tmp_path):
    with Program(tmp_path, "time.sleep(3.0)\ntime.sleep(2.0)") as program:
        assert program.go_on(STEP).next == 3 * 10**9
        assert program.go_on(4 * 10**9).next == 5 * 10**9
        assert program.go_on(6 * 10**9) is None  # rospy takes 0.1 s to end


@pytest.mark.parametrize(
    "text, seconds",
    [
        ("import atexit; atexit.register(lambda: [0 for _ in range(10**6)]); time.sleep(3.0)", 3.0),
        ("import atexit; atexit.register(time.sleep, 1.0); time.sleep(3.0)", 4.0),
        ("import threading; threading.Thread(target=time.sleep, args=(4.0,)).start(); time.sleep(3.0)", 4.0),
        ("import threading; threading.Thread(target=time.sleep, args=(9,), daemon=True).start(); time.sleep(3.0)", 3.0),
        ("from concurrent.futures import ThreadPoolExecutor as E; E().submit(time.sleep, 4.0); time.sleep(3.0)", 4.0),
    ],
)
def test_program_ends_at_the_time_at_which_all_that_it_waits_for_is_over(text, seconds, tmp_path):
    with Program(tmp_path, text) as program:
        end = round((seconds + 0.1) * 1e9)  # rospy takes 0.1 s
        assert program.go_on(end - 1)
        assert program.go_on(end) is None


def test_loop_without_pauses_does_not_run_until_the_next_request(tmp_path):
    with Program(tmp_path, "time.sleep(0.001)\nwhile True: pass") as program:
        tasks = Path(f"/proc/{program.process.pid}/task")
        for step in (1, 2):
            assert program.go_on(step * STEP).done == step * STEP
            wait_for(lambda: {task.read_text().split()[2] for task in tasks.glob("*/stat")} == {"S"}, "asleep")


def test_loop_that_waits_for_what_rounding_has_left_of_a_time_goes_on(tmp_path):
    text = "end = time.monotonic() + 1e-6\nwhile time.monotonic() < end: time.sleep(1e-12)\nprint('done')"
    assert printed(tmp_path, text, 1.0)[-1] == "done"


def test_thread_that_waits_in_an_unknown_way_does_not_stop_time(tmp_path):
    text = "import os, threading\nthreading.Thread(target=os.read, args=(os.pipe()[0], 1), daemon=True).start()\n"
    assert printed(tmp_path, f"{text}time.sleep(1.0)\nprint({AFTER})")[-1] == "1.0"


def test_other_process_that_works_holds_time_and_one_that_sleeps_does_not(tmp_path):
    works = "import subprocess, sys\nsubprocess.run([sys.executable, '-c', 'for i in range(10**6): pass'])\n"
    assert float(printed(tmp_path, f"{works}print({AFTER})", 60.0)[-1]) < 1.0
    sleeps = "import subprocess\nsubprocess.Popen(['sleep', '60'], stdout=-3, stderr=-3)\ntime.sleep(5.0)\n"
    started = time.monotonic()
    assert printed(tmp_path, f"{sleeps}print({AFTER})")[-1] == "5.0"
    assert time.monotonic() - started < 50.0


@pytest.mark.parametrize("name", ["child", "\\xff"])  # the latter is not UTF-8
def test_forked_child_lives_on_the_wall_clock_whatever_its_name_is(name, tmp_path):
    text = f"open('/proc/self/comm', 'wb').write(b'{name}')\n"
    text += "import os\nif os.fork() == 0:\n    time.sleep(0.1)\n    os._exit(7)\nprint(os.WEXITSTATUS(os.wait()[1]))"
    assert printed(tmp_path, text, 600.0)[-1] == "7"


def test_message_that_arrives_wakes_its_reader_before_time_goes_on(tmp_path):
    text = (
        "import socket, threading\ns = socket.create_server(('127.0.0.1', 0))\n"
        "print(s.getsockname()[1], flush=True)\nc, _ = s.accept()\ndata = c.recv(5)\n"
        f"print(data, {AFTER}, flush=True)\ntime.sleep(60)\n"
    )
    with Program(tmp_path, text) as program:
        reader = threading.Thread(target=program.go_on, args=(STEP,))
        reader.start()
        port = int(program.process.stdout.readline())
        reader.join()
        with socket.create_connection(("127.0.0.1", port)) as client:
            client.sendall(b"hello")
            program.go_on(2 * STEP)
            assert program.process.stdout.readline() == "b'hello' 0.01\n"


@pytest.mark.parametrize(
    "text, expected",
    [
        (
            # Two threads wait for the same byte.
            "import select, socket, threading\na, b = socket.socketpair()\n"
            "def read():\n"
            "    if select.select([a], [], [], 1.0)[0]: a.recv(1)\n"
            "    print(round(time.monotonic() - start, 6), flush=True)\n"
            "for _ in range(2): threading.Thread(target=read).start()\n"
            "time.sleep(0.5)\nb.send(b'x')\n",
            ["0.5", "1.0"],
        ),
        (
            # Threads one after another, which may have the same number.
            "import threading\n"
            "def look():\n"
            "    for _ in range(60): time.time()\n"
            "for _ in range(20):\n"
            "    thread = threading.Thread(target=look); thread.start(); thread.join()\n"
            "print(round(time.monotonic() - start, 6))\n",
            ["0.0"],
        ),
        (
            # A thread looks again and again whether another one is done, and lets it go on.
            "import queue, threading\nto, back = queue.Queue(), queue.Queue()\n"
            "def work():\n"
            "    while True: back.put(to.get())\n"
            "threading.Thread(target=work, daemon=True).start()\n"
            "before = time.process_time()\n"
            "for number in range(50):\n"
            "    to.put(number)\n"
            "    while back.empty(): time.sleep(0)\n"
            "    assert back.get() == number\n"
            "print(round(time.monotonic() - start, 6))\n",
            ["0.0"],
        ),
    ],
)
def test_threads_meet_as_without_the_agent(text, expected, tmp_path):
    assert printed(tmp_path, text) == expected


def test_one_thread_runs_at_a_time(tmp_path):
    text = """
import sys, threading
sys.setswitchinterval(1e-6)
count, begin = 0, threading.Event()
def plus_one(number): return number + 1
def add():
    global count
    begin.wait()
    for _ in range(20_000):
        count = plus_one(count)
threads = [threading.Thread(target=add) for _ in range(4)]
for thread in threads: thread.start()
begin.set()
for thread in threads: thread.join()
print(count)
"""
    assert printed(tmp_path, text) == ["80000"]


def test_thread_that_looks_again_and_again_whether_another_is_done_is_not_waited_for(tmp_path):
    text = """
import threading
done = False
def end():
    global done
    time.sleep(0.1)
    done = True
thread = threading.Thread(target=end)
thread.start()
time.sleep(0.1)  # it wakes up after the other one has begun to wait, and before that is done
while not done:
    pass
print("done")
"""
    assert printed(tmp_path, text) == ["done"]


def test_signal_handler_that_ends_a_wait_leaves_the_program_alive(tmp_path):
    text = """
import os, signal, threading
def stop(*_): raise InterruptedError
signal.signal(signal.SIGUSR1, stop)
for wait in (lambda: time.sleep(1000.0), lambda: threading.Event().wait(1000.0)):
    threading.Timer(0.2, os.kill, [os.getpid(), signal.SIGUSR1]).start()
    try: wait()
    except InterruptedError: print("interrupted")
    time.sleep(0.3)
"""
    assert printed(tmp_path, text) == ["interrupted", "interrupted"]


BY_THE_CLOCK = """
import rospy
rospy.rostime._set_rostime(rospy.Time(0, 1))
rospy.rostime.set_rostime_initialized(True)
"""


# Its main thread sleeps by rospy's clock, and a thread of its own handles what is sent to the port that it prints.
SLEEPS_BY_THE_CLOCK = """
import socket, sys, threading
server, data = socket.create_server(('127.0.0.1', 0)), None
def read():
    global data
    connection, _ = server.accept()
    received = connection.recv(5)
    for _ in range(10**6): pass
    data = received
threading.Thread(target=read, daemon=True).start()
print(server.getsockname()[1], flush=True)
rospy.sleep(0.5)
print(data, round(rospy.get_time(), 3), flush=True)
time.sleep(60)
"""


def test_rospy_wakes_up_by_the_clock_when_all_messages_are_handled(tmp_path):
    with Program(tmp_path, BY_THE_CLOCK + SLEEPS_BY_THE_CLOCK) as program:
        assert program.go_on(STEP, clock=0).done == STEP
        port = int(program.process.stdout.readline())
        program.go_on(2 * STEP, clock=4 * 10**8)
        with socket.create_connection(("127.0.0.1", port)) as client:
            client.sendall(b"hello")
            assert program.go_on(3 * STEP, clock=6 * 10**8).done == 3 * STEP
            assert program.process.stdout.readline() == "b'hello' 0.6\n"


SLEEPERS = """
import threading
def sleep(seconds):
    try:
        for _ in range(2):
            rospy.sleep(seconds)
            print(rospy.get_time(), seconds, flush=True)
    except rospy.ROSInterruptException as error:
        print(rospy.get_time(), error, flush=True)
time.sleep(0.11)
threads = [threading.Thread(target=sleep, args=[seconds]) for seconds in (0.1, 0.25, rospy.Duration(0.7))]
for thread in threads:
    thread.start()
time.sleep(0.9)
rospy.core._shutdown_flag = True
for thread in threads:
    thread.join()
"""
WOKEN = ["0.2 0.1", "0.3 0.1", "0.4 0.25", "0.7 0.25", "0.8 700000000", "1.1 ROS shutdown request"]
TOGETHER = """
import threading
def sleep(name):
    for _ in range(20):
        rospy.sleep(0.1)
        print(name, flush=True)
time.sleep(0.15)
for name in "ABC":
    threading.Thread(target=sleep, args=[name]).start()
    time.sleep(0.001)
"""
HOLDS_THE_CONDITION = """
with rospy.rostime.get_rostime_cond():
    time.sleep(0.3)
    print(rospy.get_time(), flush=True)
"""


@pytest.mark.parametrize(
    "text, ticks, later, lines",
    [
        pytest.param(SLEEPERS, 12, STEP, WOKEN, id="a sleep ends at the first tick after it, or after a shutdown"),
        pytest.param(TOGETHER, 23, 2 * STEP, [*"ABC"] * 20, id="sleeps that end at one tick end one after another"),
        pytest.param(HOLDS_THE_CONDITION, 5, 0, ["0.3"], id="a wait with the clock's condition does not stop time"),
    ],
)
def test_threads_live_by_rospys_clock(text, ticks, later, lines, tmp_path):
    """Ticks of 0.1 s, and a while after each."""
    with Program(tmp_path, BY_THE_CLOCK + text) as program:
        program.go_on(STEP)
        for tick in range(1, ticks + 1):
            program.go_on(tick * 10**8 + later, clock=tick * 10**8)
        program.process.kill()
        assert program.process.stdout.read().splitlines() == lines


def test_script_is_the_main_program_and_its_traceback_is_its_own(tmp_path):
    text = "import sys\nprint(__name__, sys.argv[1:], __file__.endswith('script.py'))\nraise ValueError(3)"
    lines = printed(tmp_path, text)
    assert lines[0] == "__main__ ['argument'] True"
    assert lines[1] == "Traceback (most recent call last):" and "script.py" in lines[2] and lines[-1] == "ValueError: 3"


SOURCES = {
    "cp1250 without a coding line": b"x = 1\n# \xf8\n",
    "UTF-16": "print(1)\n".encode("utf-16"),
    "UTF-8 with a byte-order mark": b"\xef\xbb\xbfprint(1)\n",
    "a null byte": b"x = 1\n\0y\n",
    "tabs and spaces": b"if 1:\n\tx = 1\n        y = 2\n",
    "an exception": b"def f():\n    raise ValueError(1)\nf()\n",
    "an exit status": b"raise SystemExit(3)\n",
}


@pytest.mark.parametrize("content", SOURCES.values(), ids=SOURCES)
def test_source_is_read_as_by_python3_itself(content, tmp_path):
    script = tmp_path / "script.py"
    script.write_bytes(content)
    (tmp_path / "run.py").write_text(
        f"import sys\nsys.path.insert(0, {os.path.dirname(AGENT)!r})\nfrom agent import __main__ as agent\n"
        "class Nothing:\n    def install(self, *_): pass\n"
        f"agent.load = Nothing\nsys.argv = ['', '2,0', {str(script)!r}]\nagent.main()\n"
    )
    expected, got = (
        subprocess.run([sys.executable, str(path)], capture_output=True, timeout=PATIENCE, cwd=tmp_path)
        for path in (script, tmp_path / "run.py")
    )
    own = got.stderr.split(b"line 8, in <module>\n")[-1]  # without run.py's own frame
    assert (got.stdout, got.returncode) == (expected.stdout, expected.returncode)
    assert own == expected.stderr
