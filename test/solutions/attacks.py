"""Attacks of a submission on the grader: code for the node, which prints SUCCESS for each attack that works."""

FORK_BOMB = """
import os
def bomb():
    while True:
        try:
            os.fork()
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
             FOLDER + '/out/server-start.json', FOLDER + '/out/server-job.json'):
    try:
        if path != FOLDER + '/solution.py':
            print('SUCCESS', path, len(open(path).read()), flush=True)
    except OSError as error:
        print('refused', path, error, flush=True)
"""
OUTSIDE = """
import socket
for address in (('127.0.0.1', PORT), ('1.1.1.1', 80), ('192.168.0.1', 80)):
    try:
        socket.create_connection(address, timeout=1.0)
        print('SUCCESS', address, flush=True)
    except OSError as error:
        print('refused', address, error, flush=True)
"""
KILL_ALL = """
import os, signal
for pid in [*range(2, 400), PID]:
    if pid != os.getpid():
        try:
            os.kill(pid, signal.SIGKILL)
        except OSError:
            pass
"""
FORGE = """
import os
for name in ('server-left.json', 'server-start.json', 'report.json', '../report.json'):
    try:
        os.makedirs(FOLDER + '/out', exist_ok=True)
        with open(FOLDER + '/out/' + name, 'w') as f:
            f.write('{}')
        print('wrote', name, flush=True)
    except OSError as error:
        print('refused', name, error, flush=True)
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
GIGABYTE_OF_LOG = """
import sys, threading
def shout():
    for _ in range(1024):
        sys.stdout.write('x' * 2 ** 20 + chr(10))
threading.Thread(target=shout, daemon=True).start()
"""
KILL_MASTER = """
import os, threading, time, xmlrpc.client
def strike():
    while not rospy.core.is_initialized():
        time.sleep(0.05)
    rospy.wait_for_message('/robocop_goto_as/goal', rospy.AnyMsg)
    for uri in (os.environ['ROS_MASTER_URI'],
                rospy.get_master().lookupNode('/robocop_sim')[2]):
        try:
            xmlrpc.client.ServerProxy(uri).shutdown('/robocop', 'attack')
        except Exception as error:
            print(error, flush=True)
threading.Thread(target=strike, daemon=True).start()
"""
MEMORY = """
import os, time
for _ in range(12):
    if os.fork() == 0:
        memory = bytearray(400 * 2 ** 20)
        time.sleep(60.0)
        os._exit(0)
os.wait()  # otherwise the node would finish its goals before all memory is allocated
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
BUILD_FULL = """
for number in range(40):
    with open(f'big{number}', 'wb') as f:
        for _ in range(60):
            f.write(bytes(2 ** 20))
import time
time.sleep(30.0)
"""
MEMFD = """
import array, os, socket
near, far = socket.socketpair()
try:
    for _ in range(60):
        file = os.memfd_create('hidden')
        for _ in range(60):
            os.write(file, bytes(2 ** 20))
        near.sendmsg([b'x'], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array('i', [file]))])
        os.close(file)
    print('SUCCESS memfds in a socket')
except OSError as error:
    print('refused', error)
"""
SYSTEM_V = """
import ctypes, os
libc = ctypes.CDLL(None, use_errno=True)
for name, make in (('shared memory', lambda: libc.shmget(0, 2 ** 20, 0o1600)),
                   ('semaphores', lambda: libc.semget(0, 30_000, 0o1600)),
                   ('messages', lambda: libc.msgget(0, 0o1600))):
    for _ in range(10):
        if make() < 0:
            print('refused', name, os.strerror(ctypes.get_errno()))
            break
    else:
        print('SUCCESS System V', name)
"""
OTHER_CALLS = """
import ctypes, os, platform, socket
libc = ctypes.CDLL(None, use_errno=True)
ARM = platform.machine() == 'aarch64'
for name, call in (('io_uring', lambda: libc.syscall(425, 8, ctypes.byref((ctypes.c_char * 120)()))),
                   ('add_key', lambda: libc.syscall(217 if ARM else 248, b'user', b'name', bytes(20000), 20000, -2)),
                   ('AF_VSOCK', lambda: libc.socket(40, 1, 0)),
                   ('AF_ALG', lambda: libc.socket(38, 5, 0)),
                   ('vmsplice', lambda: libc.vmsplice(os.pipe()[1], None, 0, 0))):
    if call() < 0:
        print('refused', name, os.strerror(ctypes.get_errno()))
    else:
        print('SUCCESS', name)
"""
SHARED_WITHOUT_FILE = """
import ctypes, mmap, os
libc = ctypes.CDLL(None, use_errno=True)
DONTNEED = 4
for make in (lambda size: mmap.mmap(-1, size), lambda size: mmap.mmap(os.open('/dev/zero', os.O_RDWR), size)):
    try:
        memory = make(400 * 2 ** 20)
        ctypes.memset(ctypes.addressof(ctypes.c_char.from_buffer(memory)), 1, len(memory))
        libc.madvise(ctypes.c_void_p(ctypes.addressof(ctypes.c_char.from_buffer(memory))), len(memory), DONTNEED)
        print('SUCCESS kept', memory[:3])
    except OSError as error:
        print('refused', error)
"""
NAMESPACE = """
import ctypes, os, subprocess
libc = ctypes.CDLL(None, use_errno=True)
NEW_USER, NEW_NS = 0x10000000, 0x20000
if libc.unshare(NEW_USER | NEW_NS) == 0:
    print('SUCCESS unshare')
else:
    print('refused', os.strerror(ctypes.get_errno()))
child = libc.syscall(56, NEW_USER | NEW_NS | 17, 0, 0, 0, 0)  # clone on x86-64, with SIGCHLD
if child == 0:
    os._exit(0)
print('refused' if child < 0 else 'SUCCESS clone', os.strerror(ctypes.get_errno()))
done = subprocess.run(['unshare', '--user', '--map-root-user', '--mount', 'mount', '-t', 'tmpfs', 'none', '/tmp'])
print('SUCCESS tmpfs' if done.returncode == 0 else 'refused', done.returncode)
"""
PARKED = """
import socket
pairs, parked = [], 0
try:
    while True:
        pairs.append(socket.socketpair())
        pairs[-1][0].setblocking(False)
        try:
            while True:
                parked += pairs[-1][0].send(bytes(2 ** 16))
        except BlockingIOError:
            pass
        if parked > 2 ** 28:
            print('SUCCESS', parked, 'bytes in sockets')
            break
except OSError as error:
    print('refused', parked, error)
"""
FLOOD = """
import threading
import time
def flood():
    from rosgraph_msgs.msg import Log
    while not rospy.core.is_initialized():
        pass
    topic = rospy.Publisher('/rosout', Log, queue_size=10)
    while not topic.get_num_connections():
        time.sleep(0.01)
    log = Log(name='/flood', level=8, msg='x' * 4 * 2 ** 20)
    for _ in range(400):
        topic.publish(log)
threading.Thread(target=flood, daemon=True).start()
"""
BUILD_NESTED = """
import os
for _ in range(1500):
    os.mkdir('nested')
    os.chdir('nested')
import time
time.sleep(30.0)
"""
BUILD_LONG_LINE = """
import sys
sys.stdout.write('x' * 50 * 2 ** 20 + chr(27) + '[2J')
sys.exit(1)
"""
OWN_ROSLAUNCH = """#!/bin/sh
echo '/own: [[[['
"""
KILLS_ITSELF = """
import signal, threading
def strike():
    rospy.wait_for_message('/robocop_goto_as/goal', rospy.AnyMsg)
    os.kill(os.getpid(), signal.SIGKILL)
import os
threading.Timer(1.0, strike).start()
"""
LIE = """
import os, struct, sys
channel, scheduler = sys.modules['robocop_agent.channel'], sys.modules['robocop_agent.scheduler']
wire, write = sys.modules['robocop_agent.wire'], channel.Channel._write
def replace(replaced, lie):
    def written(self, kind, body):
        if kind == replaced:
            return lie(self, body)
        write(self, kind, body)
    channel.Channel._write = written
"""
UNREADABLE = "answer to the grader can't be read"
STILL = "the node's time did not go on"
LIES = {  # code after LIE, and what the report says
    "silence": (
        "def lie(self, body):\n    while True: scheduler.sleep(0.01)\nreplace(wire.DONE, lie)",
        "it stopped answering",
    ),
    "two_threads_silence": (
        "def lie(self, body):\n"
        "    scheduler.start_new_thread(lambda: [scheduler.sleep(0.01) for _ in iter(int, 1)], ())\n"
        "    while True: scheduler.sleep(0.01)\nreplace(wire.DONE, lie)",
        "it stopped answering",
    ),
    "half_a_frame": (
        "replace(wire.DONE, lambda self, body: os.write(self._descriptor, wire.frame(wire.DONE, body)[:-1]))",
        "it stopped answering",
    ),
    "nested": (
        "replace(wire.TOPICS, lambda self, _: write(self, wire.TOPICS, b'[' * 400_000))",
        "topics can't be read",
    ),
    "malformed": (
        'replace(wire.TOPICS, lambda self, _: write(self, wire.TOPICS, b\'{"published": [[[]]], "subscribed": 7}\'))',
        "topics can't be read",
    ),
    "too_long": (
        "replace(wire.DONE, lambda self, _: os.write(self._descriptor, wire.HEAD.pack(2**31, wire.DONE)))",
        UNREADABLE,
    ),
    "no_numbers": ("replace(wire.DONE, lambda self, _: write(self, wire.DONE, b'done'))", UNREADABLE),
    "unknown_kind": ("replace(wire.DONE, lambda self, body: write(self, 77, body))", UNREADABLE),
    "no_time": ("replace(wire.DONE, lambda self, _: write(self, wire.DONE, wire.TIMES.pack(0, 0)))", STILL),
    "in_advance": ("replace(wire.DONE, lambda self, body: [write(self, wire.DONE, body) for _ in range(2)])", STILL),
    "far_ahead": (
        "replace(wire.DONE, lambda self, b: write(self, wire.DONE, wire.TIMES.pack(1 << 60, 1 << 62)))",
        STILL,
    ),
    "done_before_it_is": (
        "read = channel.Channel._read\ndef hasty(self):\n    kind, body = read(self)\n    if kind == wire.GO:\n"
        "        write(self, wire.DONE, wire.TIMES.pack(wire.TIMES.unpack_from(body)[0], 1 << 62))\n"
        "    return kind, body\nchannel.Channel._read = hasty\nreplace(wire.DONE, lambda self, body: None)",
        "it stopped answering",
    ),
    "closed": (
        "def lie(self, body):\n    os.close(self._descriptor)\n    while True: scheduler.sleep(0.01)\n"
        "replace(wire.DONE, lie)",
        "closed its connection to the grader",
    ),
    # These are graded: nothing of it counts, or only as a topic that nobody hears.
    "early": (
        "replace(wire.DONE, lambda self, b: write(self, wire.DONE, b[:8] + struct.pack('<q', -2**62) + b[16:]))",
        "",
    ),
    "other_topics": (
        "def lie(self, body):\n    for it in (wire.named('/a', body), body): write(self, wire.MESSAGE, it)\n"
        "replace(wire.MESSAGE, lie)",
        "",
    ),
    "rubbish": (
        "replace(wire.MESSAGE, lambda self, body: write(self, wire.MESSAGE, body[:2] + body[2:][::-1]))",
        UNREADABLE,
    ),
}
