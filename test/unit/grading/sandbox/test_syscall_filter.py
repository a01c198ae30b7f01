"""What calls to the system a program in the sandbox may make."""

import textwrap

import pytest

CALLS = """
import ctypes, errno, os, platform, resource, socket, sys
libc = ctypes.CDLL(None, use_errno=True)
def outcome(result):
    return errno.errorcode[ctypes.get_errno()] if result == -1 else "SUCCESS"
"""


@pytest.fixture
def called(printed):
    """Runs a Python program in the sandbox that may use what CALLS has; its lines."""
    return lambda code: printed(CALLS + textwrap.dedent(code))


REFUSED = [
    "libc.semget(0, 100, 0o1600)",
    "libc.msgget(0, 0o1600)",
    "libc.shmget(0, 4096, 0o1600)",
    "libc.mq_open(b'/queue', os.O_CREAT | os.O_RDWR, 0o600, None)",
    "libc.syscall(425, 8, ctypes.byref((ctypes.c_char * 120)()))",  # io_uring_setup on all architectures
    "libc.syscall({'x86_64': 250, 'aarch64': 219}[platform.machine()], 0, -3, 1)",  # keyctl
    "libc.memfd_create(b'hidden', 0)",
    "libc.inotify_init1(0)",
    "libc.vmsplice(1, None, 0, 0)",
    "libc.splice(0, None, 1, None, 1, 0)",
    "libc.ptrace(0, 0, None, None)",
    "libc.unshare(0x10000000)",
    "libc.syscall({'x86_64': 56, 'aarch64': 220}[platform.machine()], 0x10020011, 0, 0, 0, 0)",  # clone, of namespaces
]


def test_call_that_is_refused_fails_as_on_a_kernel_without_it(called):
    lines = called("".join(f"print(outcome({call}))\n" for call in REFUSED))
    assert dict(zip(REFUSED, lines)) == dict.fromkeys(REFUSED, "ENOSYS")


def test_only_sockets_of_the_usual_families_can_be_made(called):
    code = """
    made = []
    for family in range(64):
        if libc.socket(family, socket.SOCK_DGRAM, 0) != -1 or libc.socket(family, socket.SOCK_RAW, 0) != -1:
            made.append(family)
        elif ctypes.get_errno() not in (errno.EAFNOSUPPORT, errno.EPERM):
            print(family, os.strerror(ctypes.get_errno()))
    print(made, [outcome(libc.socket(family, 2, 0)) for family in (38, 40, 2 ** 32 - 1)])
    """
    assert called(code) == [f"[1, 2, 10, 16] {['EAFNOSUPPORT'] * 3}"]


def test_buffers_of_few_sockets_keep_their_size_and_other_options_work(called):
    code = """
    for family, kind in ((socket.AF_UNIX, socket.SOCK_STREAM), (socket.AF_INET, socket.SOCK_STREAM),
                         (socket.AF_INET, socket.SOCK_DGRAM)):
        one = socket.socket(family, kind)
        for option in (socket.SO_SNDBUF, socket.SO_RCVBUF):
            before = one.getsockopt(socket.SOL_SOCKET, option)
            one.setsockopt(socket.SOL_SOCKET, option, 2 ** 22)
            libc.setsockopt(one.fileno(), ctypes.c_long(2 ** 32 + 1), option, ctypes.byref(ctypes.c_int(2 ** 22)), 4)
            assert one.getsockopt(socket.SOL_SOCKET, option) == before
    tcp = socket.socket()
    tcp.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    tcp.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    tcp.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    tcp.settimeout(0.1)
    print("fine", tcp.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE), resource.getrlimit(resource.RLIMIT_NOFILE))
    """
    assert called(code) == ["fine 1 (256, 256)"], "what waits in sockets counts as nobody's memory"


def test_priorities_stay_as_they_are(called):
    code = """
    before = os.nice(0), os.sched_getscheduler(0)
    os.setpriority(os.PRIO_PROCESS, 0, 19)
    os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
    print((os.nice(19), os.sched_getscheduler(0)) == before)
    """
    assert called(code) == ["True"]


def test_memory_cannot_be_shared_without_a_file(called):
    code = """
    import mmap
    for make in (lambda: mmap.mmap(-1, 4096), lambda: mmap.mmap(os.open("/dev/zero", os.O_RDWR), 4096)):
        try:
            make()
            print("SUCCESS")
        except OSError as error:
            print(errno.errorcode[error.errno])
    mmap.mmap(-1, 4096, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)[:3] = b"abc"
    with open("/tmp/shared", "w+b") as file:
        file.truncate(4096)
        mmap.mmap(file.fileno(), 4096)[:3] = b"abc"
        print(file.read(3), open("/dev/zero", "rb").read(2))
    """
    assert called(code) == ["ENOSYS", "ENODEV", "b'abc' b'\\x00\\x00'"]


def test_calls_of_another_architecture_kill_the_process(called):
    code = """
    import mmap
    if platform.machine() == "x86_64":
        # mov eax, 20 (getpid of i386); int 0x80; ret
        page = mmap.mmap(-1, 4096, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, 7)
        page.write(bytes([0xB8, 20, 0, 0, 0, 0xCD, 0x80, 0xC3]))
        os.fork() or ctypes.CFUNCTYPE(ctypes.c_int)(ctypes.addressof(ctypes.c_char.from_buffer(page)))()
        print(os.wait()[1] & 0x7F)
    else:
        print(31)
    """
    assert called(code) == ["31"]


def test_what_nodes_use_works(called):
    code = """
    import asyncio, concurrent.futures, multiprocessing, shutil, signal, sqlite3, ssl, subprocess, tempfile, threading
    import numpy
    assert numpy.linalg.inv(numpy.eye(300) * 2.0)[0, 0] == 0.5
    assert subprocess.run(["/bin/sh", "-c", "ls / | wc -l"], stdout=subprocess.PIPE, check=True).stdout
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        assert sum(pool.map(abs, range(-9, 0))) == 45
    with multiprocessing.Pool(2) as pool:
        assert pool.map(abs, [-1, -2]) == [1, 2]
    with sqlite3.connect("/tmp/file.db") as database:
        database.execute("pragma journal_mode = wal")
        database.execute("create table poses (x real)")
    async def echo():
        async def answer(reader, writer):
            writer.write(await reader.readline())
        server = await asyncio.start_server(answer, "localhost", 0)
        reader, writer = await asyncio.open_connection(*server.sockets[0].getsockname()[:2])
        writer.write(b"hello\\n")
        assert await reader.readline() == b"hello\\n"
        process = await asyncio.create_subprocess_exec("/bin/true")
        assert await process.wait() == 0
    asyncio.run(echo())
    shutil.copyfile("/etc/passwd", "/tmp/copy")
    subprocess.run(["cp", "-a", "/tmp/copy", "/tmp/copy2"], check=True)
    subprocess.run("mktemp; mv /tmp/copy2 /tmp/copy3; date; id; df; nproc; python3 -V; env; sort /tmp/copy3 | tail -1",
                   shell=True, check=True, stdout=subprocess.DEVNULL)
    assert open("/tmp/copy").read()
    assert socket.getaddrinfo("localhost", 80)
    signal.signal(signal.SIGALRM, lambda *_: None)
    signal.setitimer(signal.ITIMER_REAL, 0.01)
    print("fine")
    """
    assert called(code) == ["fine"]
