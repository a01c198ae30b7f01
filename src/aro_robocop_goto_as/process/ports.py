"""Free TCP ports on the loopback interface."""

import contextlib
import random
import socket

PORTS = range(20_000, 32_768)  # below those that Linux gives to programs which ask for any port (ip_local_port_range)


def free_port() -> int:
    """A TCP port of 127.0.0.1 that was free a moment ago."""
    chance = random.SystemRandom()
    while True:
        port = chance.choice(PORTS)
        with contextlib.suppress(OSError), socket.socket() as probe:
            probe.bind(("127.0.0.1", port))
            return port
