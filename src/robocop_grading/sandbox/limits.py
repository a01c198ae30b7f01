"""The limits of a hand-in while it is built and run. The kernel limits each process, guard.py all of them together."""

MB = 1024**2

# -- one process --
MAX_ADDRESS_SPACE = 4096 * MB  # bytes; numpy alone reserves more than one GB
MAX_FILES = 256  # open files; data that waits in pipes and sockets counts as no process's memory
MAX_CPU_TIME = 200  # [s], also of all processes together: of a part's nodes, one after the other
CPU_GRACE = 5  # [s] from SIGXCPU, which distinguishes the limit from an external SIGKILL, to the kernel's SIGKILL

# -- all processes together --
MAX_TASKS = 200  # processes and threads of a user; a rospy node has some 30
MAX_PROCESSES = 64  # at the same time; a fork bomb would take the processor from everybody until its time is used up
MAX_MEMORY = 2048 * MB  # bytes; a node with numpy and OpenCV takes some 200 MB
MAX_SPACE = 64 * MB  # bytes of a writable place, all in memory, except:
MAX_HAND_IN = 256 * MB  # bytes of what was handed in, unpacked and built; the lab's takes 2 MB

# -- what the grader waits for --
MAX_IDLE = 60.0  # [s, wall] in which a node has to do something while the grader waits for its answer:
MIN_WORK = 0.5  # [s] of processor time; with sixty busy processes on a processor it gets twice as much

# -- the preparation of a hand-in: it is unpacked, built and read --
MAX_PREPARATION_CPU_TIME = 180.0  # [s] of all processes together
PREPARATION_TIMEOUT = 900.0  # [s, wall]; a build that waits for something that does not come uses no processor
