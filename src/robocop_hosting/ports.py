"""Free TCP ports on the loopback interface."""

import contextlib
import random
import socket

MAX_TRIES = 1000
PORTS = range(20_000, 32_768)  # below those that Linux gives to programs which ask for any port (ip_local_port_range)


def free_port() -> int:
    """A TCP port of 127.0.0.1 that was free a moment ago; OSError if none is found."""
    for port in random.SystemRandom().sample(PORTS, MAX_TRIES):
        with socket.socket() as probe, contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port
    raise OSError(f"none of {MAX_TRIES} ports of 127.0.0.1 is free")
