"""bench.client: it subscribes as ROS's nodes do, and counts what arrives, however it is split."""

import os
import random
import socket
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path
from xmlrpc.server import SimpleXMLRPCServer

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosgraph.network import decode_ros_handshake_header, encode_ros_handshake_header

from aro_robocop_goto_as.bench import client as client_module
from aro_robocop_goto_as.bench.client import Client, Link, connect
from aro_robocop_goto_as.errors import BenchError


def framed(stamp_ns, size=40):
    """A message that begins with a header, as it is sent: its length, then itself."""
    return struct.pack("<IIII", size, 7, stamp_ns // 10**9, stamp_ns % 10**9) + bytes(size - 12)


def stamps(rate, count, first=1):
    """Stamps [ns] of messages at a rate [Hz], rounded down as the simulator does."""
    return [k * 10**9 // rate for k in range(first, first + count)]


def counts(link):
    return link.messages, link.first_ns, link.last_ns


def counted(times):
    return len(times), times[0], times[-1]


def received(*streams):
    """A client that has read these streams to their ends. It may read two pieces of a stream at once."""
    with Client() as client:
        for number, pieces in enumerate(streams):
            ours, theirs = socket.socketpair()
            client.add(str(number), theirs)
            with ours:
                for piece in pieces:
                    ours.sendall(piece)
        client.deliveries({str(number): 1 for number in range(len(streams))})  # waits for the ends
    return client


def client_with(**topics):
    """A client that has received messages with these stamps [ns] on its topics."""
    client = Client()
    for topic, times in topics.items():
        client.links[topic] = Link(*counted(times), 1)
    return client


@given(st.lists(st.integers(12, 60), min_size=1, max_size=8), st.data())
@settings(max_examples=50, deadline=None)
def test_messages_are_counted_however_the_stream_is_split(sizes, data):
    times = stamps(30, len(sizes))
    stream = b"".join(framed(at, size) for at, size in zip(times, sizes))
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=12)))
    client = received([stream[start:end] for start, end in zip([0, *cuts], [*cuts, len(stream)])])
    assert counts(client.links["0"]) == counted(times)


def test_every_connection_has_its_own_count_and_incomplete_messages_do_not_count():
    before = time.monotonic()
    times = stamps(30, 10_000)
    whole = b"".join(framed(at, 700) for at in times)  # more than is read at once
    client = received([whole], [framed(3)[:20], framed(3)[20:], framed(4)[:-1]], [])
    assert [counts(client.links[topic]) for topic in "012"] == [counted(times), (1, 3, 3), (0, 0, 0)]
    assert client.newest_ns == times[-1]
    first_at = client.first_at()
    assert set(first_at) == {"0", "1"} and all(before < at < time.monotonic() for at in first_at.values())


def test_message_too_short_for_a_header_is_an_error():
    with pytest.raises(BenchError, match="too short"):
        received([framed(1), struct.pack("<I", 4) + b"abcd" + framed(2)])


def test_topics_that_end_in_the_middle_of_a_step_lose_no_message():
    rates = {"scan": 5, "odom": 30, "late": 30}
    odom, late = stamps(30, 61), stamps(30, 40, first=21)  # odom at 61/30 s was sent when the simulator ended
    client = client_with(scan=stamps(5, 9), odom=odom, late=late)
    assert client.deliveries(rates) == (10 + 60 + 40, 9 + 60 + 40)  # the scan at 2 s is missing, and counted as lost
    assert client_with(scan=stamps(5, 10), odom=odom, late=late).deliveries(rates) == (110, 110)


@given(st.integers(1, 10**6), st.integers(2, 500), st.sampled_from([5, 30]))
def test_missing_messages_count_as_lost(first, count, rate):
    times = stamps(rate, count, first)
    lost = set(random.Random(count).sample(times[1:-1], (count - 2) // 4))
    client = client_with(gaps=[at for at in times if at not in lost], whole=times)
    expected, delivered = client.deliveries({"gaps": rate, "whole": rate})
    assert (expected, delivered) == (2 * (count - 1), 2 * (count - 1) - len(lost))


def test_processor_time_is_that_of_the_reading_thread():
    with Client() as client:
        deadline = time.process_time() + 0.2
        while time.process_time() < deadline:
            pass
        assert 0.0 <= client.cpu < 0.1


@pytest.fixture
def publisher():
    """A node with one topic, /scan, that sends three messages to each subscriber and closes; yields its URI."""
    links, node = socket.create_server(("127.0.0.1", 0)), SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
    granted = (1, "", ["TCPROS", *links.getsockname()])
    node.register_function(lambda _caller, topic, _protocols: granted, "requestTopic")

    def send():
        link = links.accept()[0]
        with link:
            length = link.recv(4, socket.MSG_WAITALL)
            (size,) = struct.unpack("<I", length)
            wanted = decode_ros_handshake_header(length + link.recv(size, socket.MSG_WAITALL))
            known = wanted["topic"] == "/scan"
            link.sendall(encode_ros_handshake_header({"md5sum": "1"} if known else {"error": "never heard of it"}))
            link.sendall(b"".join(framed(at) for at in stamps(5, 3)) if known else b"")

    threading.Thread(target=send, daemon=True).start()
    threading.Thread(target=node.serve_forever, args=(0.01,), daemon=True).start()
    yield f"http://127.0.0.1:{node.server_address[1]}/"
    node.shutdown()
    node.server_close()
    links.close()


def test_messages_of_a_publisher_are_counted_from_the_first_on(publisher):
    with Client() as client:
        client.add("/scan", connect(publisher, "/scan"))
        assert client.deliveries({"/scan": 5}) == (2, 2)
        assert counts(client.links["/scan"]) == counted(stamps(5, 3))


def test_refused_subscription_is_reported_with_topic_and_publishers_message(publisher):
    with pytest.raises(BenchError, match="/odom: never heard of it"):
        connect(publisher, "/odom")


READ_UNDER_SANITIZERS = """
import random, socket, sys
from aro_robocop_goto_as import compiled
compiled.find = lambda name, folders=None: sys.argv[1]
from aro_robocop_goto_as.bench.client import Client
random.seed(0)
for size in [0, 1, 3, 4, 15, 16, 100, 1 << 19]:
    noise = b"".join(random.choice([0, 12, 13, 255]).to_bytes(4, "little") for _ in range(size))
    with Client() as client:
        ours, theirs = socket.socketpair()
        client.add("/noise", theirs)
        with ours:
            ours.sendall((12).to_bytes(4, "little") + noise)
        while client.links["/noise"].open:
            pass
print("sound")
"""


@pytest.mark.slow
def test_reading_any_bytes_is_sound_under_sanitizers(tmp_path):
    library = str(tmp_path / "drain.so")
    source = Path(client_module.__file__).with_name("drain.c")
    checks = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    warnings = ["-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror"]
    subprocess.run(
        ["cc", "-std=c99", "-g", "-O1", *warnings, *checks, "-fPIC", "-shared", str(source), "-o", library], check=True
    )
    runtime = subprocess.run(["cc", "-print-file-name=libasan.so"], check=True, capture_output=True, text=True).stdout
    done = subprocess.run(
        [sys.executable, "-c", READ_UNDER_SANITIZERS, library],
        env={**os.environ, "LD_PRELOAD": runtime.strip(), "ASAN_OPTIONS": "detect_leaks=0"},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stdout) == (0, "sound\n"), done.stderr
