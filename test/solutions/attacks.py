"""Attacks of a submission on the grader: code for the node, which prints SUCCESS, or that it was refused."""

FORK_BOMB = """
import os
def bomb():
    while True:
        try:
            os.fork()
        except OSError as error:
            try:
                os.mkdir('/tmp/told')  # by the first one
                os.write(1, f'refused {error}'.encode() + bytes([10]))
            except OSError:
                pass
if os.fork() == 0:
    bomb()
"""
FULL_DISK = """
import os
for place in (os.path.expanduser('~'), '/tmp', '/dev/shm', '/var/tmp', '/'):
    try:
        for number in range(64):
            with open(f'{place}/big{number}', 'wb') as f:
                for _ in range(16):
                    f.write(bytes(2 ** 20))
        print('SUCCESS', place, 'took a gigabyte', flush=True)
    except OSError as error:
        print('refused', place, error, flush=True)
"""
READ = """
import glob, os
for path in ('/root/.bashrc', '/etc/shadow', PLAN, *glob.glob(os.path.dirname(FOLDER) + '/*/solution.py'),
             FOLDER + '/out/server-start.bag'):
    try:
        if path != FOLDER + '/solution.py':
            print('SUCCESS', path, len(open(path).read()), flush=True)
    except OSError as error:
        print('refused', path, error, flush=True)
"""
KILL_ALL = """
import os, signal
def kill(pid):
    try:
        os.kill(pid, signal.SIGKILL)
        return f'SUCCESS killed {pid}'
    except OSError as error:
        return f'refused {error}'
own = [int(thread) for thread in os.listdir('/proc/self/task')]
print(*{kill(pid) for pid in [*range(2, 400), PID] if pid not in own}, sep=chr(10), flush=True)
"""
ENDLESS = """
import threading
def spin():
    while True:
        pass
for _ in range(4):
    threading.Thread(target=spin, daemon=True).start()
while True:
    pass
"""
BUILD = """
import os, socket
for path in ('/root/.bashrc', '/etc/shadow', PLAN, NEIGHBOUR, os.path.join(os.path.dirname(__file__), 'link')):
    try:
        print('SUCCESS', path, len(open(path).read()))
    except OSError as error:
        print('refused', path, error)
for path in (NEIGHBOUR, '/var/tmp/robocop-was-here', os.path.expanduser('~root/robocop-was-here')):
    try:
        open(path, 'a').close()
        print('SUCCESS', path)
    except OSError as error:
        print('refused', path, error)
try:
    socket.create_connection(('127.0.0.1', PORT), timeout=1.0)
    print('SUCCESS', PORT)
except OSError as error:
    print('refused', PORT, error)
if 'SECRET_OF_THE_TEACHER' in os.environ:
    print('SUCCESS environment')
"""
"""Code run by a package's CMakeLists.txt or its launch file."""
BUILD_NESTED = """
import os
for _ in range(1500):
    os.mkdir('nested')
    os.chdir('nested')
"""
BUILD_LONG_LINE = """
import sys
sys.stdout.write('x' * 50 * 2 ** 20 + chr(27) + '[2J')
sys.exit(1)
"""
BUILD_LEAVES = """
from subprocess import DEVNULL, Popen
Popen(['setsid', 'sh', '-c', 'sleep 600; true', FOLDER], stdout=DEVNULL, stderr=DEVNULL)
print('left running')
"""
SPY = """
import glob, os, re, threading
import rospy
from gazebo_msgs.srv import GetModelState, GetWorldProperties
def spy(goal_id):
    def ask(name, kind, *arguments):
        return str(rospy.ServiceProxy('/gazebo/' + name, kind)(*arguments))
    seen = [goal_id, ask('get_model_state', GetModelState, 'burger', ''),
            ask('get_world_properties', GetWorldProperties), sorted(rospy.get_param('/').items()),
            sorted(rospy.get_published_topics()), sorted(os.environ.items()), threading.active_count(),
            sorted(glob.glob('/tmp/*') + glob.glob(os.path.expanduser('~/*'))),
            [open(path, 'rb').read() for path in sorted(glob.glob('/proc/[0-9]*/cmdline'))]]
    print('SEEN', re.sub(r'(goal-|secs: +|sim_time: +)[0-9.]+', r'\\1', str(seen)), flush=True)
"""
"""What a server can read about a scenario except from its sensors, without the time."""
LIE = """
import os, struct, sys
channel, scheduler = sys.modules['robocop_agent.request_loop'], sys.modules['robocop_agent.scheduler']
wire, write = sys.modules['robocop_agent.wire'], channel.RequestLoop._write
def lied():
    os.write(1, b'LIED' + bytes([10]))
def replace(replaced, lie):
    def written(self, kind, body):
        if kind == replaced:
            return lie(self, body)
        write(self, kind, body)
    channel.RequestLoop._write = written
"""
LIES = {  # code after LIE, and what the report says
    "two_threads_silence": (
        "def lie(self, body):\n    lied()\n"
        "    scheduler.start_new_thread(lambda: [scheduler.sleep(0.01) for _ in iter(int, 1)], ())\n"
        "    while True: scheduler.sleep(0.01)\nreplace(wire.DONE, lie)",
        "it stopped answering",
    ),
    "done_before_it_is": (
        "read, told = channel.RequestLoop._read, set()\ndef hasty(self):\n    kind, body = read(self)\n"
        "    if kind == wire.GO:\n        lied()\n        told.add(body[:8])\n"
        "        write(self, wire.DONE, body[:8] + struct.pack('<q', 1 << 62))\n"
        "    return kind, body\nchannel.RequestLoop._read = hasty\n"
        "replace(wire.DONE, lambda self, b: b[:8] in told or write(self, wire.DONE, b))",
        "",
    ),
    # These are graded: nothing of it counts, or only as a topic that nobody hears.
    "early": (
        "replace(wire.DONE, lambda self, b: [lied(), write(self, wire.DONE, b[:8] + struct.pack('<q', -2**62))])",
        "",
    ),
}
