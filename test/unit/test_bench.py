"""The bench's pure parts, its client, and the processes it starts."""

import json
import math
import random
import signal
import socket
import struct
import sys
import threading
import time
from pathlib import Path
from xmlrpc.server import SimpleXMLRPCServer

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.bench import cases, report, subscribe
from aro_robocop_goto_as.bench.cases import Case, parse_cases
from aro_robocop_goto_as.bench.frames import Count, FrameCounter, deliveries, framed
from aro_robocop_goto_as.bench.processes import Child, Client, running
from aro_robocop_goto_as.bench.results import Floor, Measured, Run
from aro_robocop_goto_as.errors import BenchError
from aro_robocop_goto_as.param_loading import from_dict
from aro_robocop_goto_as.params import SimParams
from aro_robocop_goto_as.world.load import find_world, load_world
from aro_robocop_goto_as.world.model import Plane

ROOT = Path(__file__).resolve().parents[2]
WHERE = report.Conditions("Some CPU", 2, "3.8.10", "1.17", "3.2", (0.1, 0.2, 0.3), 5.0, 3)


def message(stamp_ns, size=40):
    """A serialised message that begins with a header."""
    return struct.pack("<III", 7, stamp_ns // 10**9, stamp_ns % 10**9) + bytes(size - 12)


def stamps(rate, count, first=1):
    """Stamps [ns] of messages at a rate [Hz], rounded down as the simulator does."""
    return [k * 10**9 // rate for k in range(first, first + count)]


def counted(times):
    return Count(len(times), times[0], times[-1])


# Cases


def test_default_cases_are_both_engines_with_all_robot_counts_except_excluded_ones():
    assert [case.name for case in parse_cases([])] == [
        "wheels:1",
        "wheels:10",
        "kinematic:1",
        "kinematic:10",
        "kinematic:50",
    ]


@pytest.mark.parametrize(
    "words, names",
    [
        (["wheels:50"], ["wheels:50"]),
        (["kinematic"], ["kinematic:1", "kinematic:10", "kinematic:50"]),
        (["kinematic:3,wheels:1", "wheels:1"], ["kinematic:3", "wheels:1"]),
    ],
)
def test_case_is_given_as_drive_or_as_drive_and_number_of_robots(words, names):
    assert [case.name for case in parse_cases(words)] == names


@pytest.mark.parametrize("word", ["legs", "wheels:", "wheels:many", "wheels:0", "kinematic:1000", "wheels:-1"])
def test_impossible_case_is_refused_by_name(word):
    with pytest.raises(BenchError, match=word):
        parse_cases([word])


@pytest.mark.parametrize("case", parse_cases([]) + [Case("wheels", 50)], ids=lambda case: case.name)
def test_parameters_of_a_case_are_valid_and_its_topics_those_of_its_robots(case):
    params = from_dict(SimParams, case.params(0.0), case.name)
    assert (params.physics_rate, params.cmd_vel_timeout) == (case.physics_rate, 0.0)
    assert len(case.topics()) == 2 * case.robots
    assert sum(case.topics().values()) == 35 * case.robots


def test_robots_circle_clear_of_obstacles_and_of_each_other():
    world = load_world(find_world("bench", str(ROOT / "worlds")))
    solid = [item for item in world.obstacles if not isinstance(item.geometry, Plane)]
    assert len([item for item in solid if "walls" not in item.name]) == 9
    places = np.array(cases.positions())
    turns = np.linspace(0.0, 2.0 * math.pi, 36)
    radius = cases.LINEAR / cases.ANGULAR
    circle = np.stack([radius * np.sin(turns), radius * (1.0 - np.cos(turns))], axis=1)
    path = places[:, None, :] + circle
    pillars = np.array([item.pose.position[:2] for item in solid if "walls" not in item.name])
    corner = math.hypot(0.25, 0.25)  # [m] from a block's centre
    assert np.linalg.norm(path[:, :, None] - pillars, axis=-1).min() > corner + 0.105
    assert np.abs(path).max() < 4.85 - 0.105
    apart = np.linalg.norm(places[:, None] - places, axis=-1) + 9.0 * np.eye(len(places))
    assert apart.min() >= 1.0  # all robots circle alike, so they keep their distances


# Frames


@given(st.lists(st.integers(12, 60), min_size=1, max_size=8), st.integers(0, 2**32), st.data())
def test_frames_are_counted_however_the_stream_is_split(sizes, seed, data):
    times = stamps(30, len(sizes))
    stream = b"".join(framed(message(at, size)) for at, size in zip(times, sizes))
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=12)))
    counter = FrameCounter()
    for start, end in zip([0, *cuts], [*cuts, len(stream)]):
        counter.feed(stream[start:end])
    assert counter.count == counted(times)


def test_a_frame_counts_only_when_it_is_complete():
    counter, stream = FrameCounter(), framed(message(5))
    counter.feed(stream[:-1])
    assert counter.count == Count()
    counter.feed(stream[-1:])
    assert counter.count == Count(1, 5, 5)


def test_message_too_short_for_a_header_is_an_error():
    with pytest.raises(BenchError, match="4 bytes"):
        FrameCounter().feed(framed(b"abcd"))


def test_topics_that_end_in_the_middle_of_a_step_lose_no_message():
    odom, scan = stamps(30, 61), stamps(5, 9)  # odom at 61/30 s was sent when the simulator ended
    counts = {"scan": counted(scan), "odom": counted(odom), "late": counted(stamps(30, 40, first=21))}
    expected, delivered = deliveries(counts, {"scan": 5, "odom": 30, "late": 30})
    assert (expected, delivered) == (10 + 60 + 40, 9 + 60 + 40)  # the scan at 2 s is missing, and counted as lost
    counts["scan"] = counted(stamps(5, 10))
    assert deliveries(counts, {"scan": 5, "odom": 30, "late": 30}) == (110, 110)


@given(st.integers(1, 10**6), st.integers(2, 500), st.sampled_from([5, 30]))
def test_missing_messages_count_as_lost(first, count, rate):
    times = stamps(rate, count, first)
    lost = set(random.Random(count).sample(times[1:-1], (count - 2) // 4))
    counts = {"gaps": counted([at for at in times if at not in lost]), "whole": counted(times)}
    expected, delivered = deliveries(counts, {"gaps": rate, "whole": rate})
    assert (expected, delivered) == (2 * (count - 1), 2 * (count - 1) - len(lost))


# The client


def test_decoding_an_encoded_connection_header_returns_its_fields():
    fields = {"topic": "/scan", "type": "*", "message_definition": "a=b\nc"}
    encoded = subscribe.encode_header(fields)
    assert struct.unpack_from("<I", encoded)[0] == len(encoded) - 4
    assert subscribe.decode_header(encoded[4:]) == fields


@pytest.fixture
def publisher():
    """A node with one topic, /scan, that sends three messages to each subscriber and closes; yields its URI."""
    links, node = socket.create_server(("127.0.0.1", 0)), SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
    granted = (1, "", ["TCPROS", *links.getsockname()])
    node.register_function(lambda _caller, topic, _protocols: granted, "requestTopic")

    def send():
        link = links.accept()[0]
        with link:
            (length,) = struct.unpack("<I", link.recv(4, socket.MSG_WAITALL))
            wanted = subscribe.decode_header(link.recv(length, socket.MSG_WAITALL))
            known = wanted["topic"] == "/scan"
            link.sendall(subscribe.encode_header({"md5sum": "1"} if known else {"error": "never heard of it"}))
            link.sendall(b"".join(framed(message(at)) for at in stamps(5, 3)) if known else b"")

    threading.Thread(target=send, daemon=True).start()
    threading.Thread(target=node.serve_forever, args=(0.01,), daemon=True).start()
    yield f"http://127.0.0.1:{node.server_address[1]}/"
    node.shutdown()
    node.server_close()
    links.close()


def test_connect_returns_the_connection_after_its_header(publisher):
    counter = FrameCounter()
    with subscribe.connect(publisher, "/scan") as link:
        for data in iter(lambda: link.recv(50), b""):
            counter.feed(data)
    assert counter.count == counted(stamps(5, 3))


def test_refused_subscription_is_reported_with_topic_and_publishers_message(publisher):
    with pytest.raises(BenchError, match="/odom: never heard of it"):
        subscribe.connect(publisher, "/odom")


def test_client_process_counts_messages_and_open_connections(tmp_path):
    with running(Client(tmp_path / "log", "--listen")) as client:
        port = int(client.line())
        links = [socket.create_connection(("127.0.0.1", port)) for _ in range(2)]
        for at in stamps(30, 100):
            links[0].sendall(framed(message(at))[:20])
            links[0].sendall(framed(message(at))[20:])
        links[1].sendall(framed(message(3)))
        client.wait_until(lambda: client.tally().messages == 101, "all messages")
        tally = client.tally()
        assert tally.counts == {"0": counted(stamps(30, 100)), "1": Count(1, 3, 3)}
        assert (tally.newest_ns, tally.open, set(tally.first_at)) == (stamps(30, 100)[-1], 2, {"0", "1"})
        assert max(tally.first_at.values()) <= tally.time <= time.monotonic()
        for link in links:
            link.close()
        client.wait_until(lambda: client.tally().open == 0, "the ends")
    assert client.process.returncode == 0


def test_ended_process_is_reported_with_its_last_line(tmp_path):
    with running(Child("the node", ["sh", "-c", "echo no such world; echo; exit 3"], tmp_path / "log")) as child:
        with pytest.raises(BenchError, match="the node ended with status 3: no such world"):
            child.wait_until(lambda: False, "never")


def test_processor_time_and_peak_memory_of_a_process_are_measured(tmp_path):
    code = "import time; memory = bytearray(50_000_000)\nwhile time.process_time() < 0.3: pass\ntime.sleep(60)"
    with running(Child("the node", [sys.executable, "-c", code], tmp_path / "log")) as child:
        child.wait_until(lambda: child.cpu() >= 0.3, "its processor time")
        assert 50e6 < child.peak_memory() < 100e6
    assert child.process.returncode == -signal.SIGINT


# The report


def measured(case, error=None):
    """Three repeats, with ten messages lost in all."""
    floors = [Floor(factor, 0.0009, 20e-6, 150e-6, 3.4e-6) for factor in (1000.0, 1200.0, 1100.0)]
    fastest = [Run(factor, 0.0015, 60_000_000, 0.5, 5000, 4995, 0.4) for factor in (500.0, 600.0, 540.0)]
    paced = [
        Run(1.0, cpu, 61_000_000, start, 100, 100, 0.01)
        for cpu, start in ((0.0041, 0.52), (0.0052, 0.5), (0.0045, 0.61))
    ]
    return Measured(case, floors, fastest, paced[:2], error) if error else Measured(case, floors, fastest, paced)


def test_the_table_shows_medians_and_spreads_in_aligned_columns():
    text = report.table([measured(Case("kinematic", 1)), measured(Case("wheels", 10))], WHERE)
    assert "Some CPU, 2 cores; Python 3.8.10" in text and "load before: 0.10 0.20 0.30" in text
    lines = [line for line in text.splitlines() if line.startswith("|")]
    assert {len(line) for line in lines[:4]} == {len(lines[0])}
    cells = dict(zip(*([cell.strip() for cell in line.strip("|").split("|")] for line in (lines[0], lines[2]))))
    assert cells == {
        "drive": "kinematic 30 Hz",
        "robots": "1",
        "factor": "540 (500-600)",
        "floor": "1100 (1000-1200)",
        "of floor": "0.50 (0.49-0.50)",
        "CPU at 1 [ms/s]": "4.5 (4.1-5.2)",
        "memory [MB]": "61 (61-61)",
        "first scan [s]": "0.52 (0.50-0.61)",
        "messages": "15285",
        "lost": "15",
    }
    assert "| 20.0 (20.0-20.0)" in text and "wheels:50 left out" in text


def test_a_failed_case_has_a_row_and_a_reason():
    text = report.table(
        [
            measured(Case("wheels", 50), "the simulator ended with status 1: no"),
            Measured(Case("wheels", 1), error="no master"),
        ],
        WHERE,
    )
    assert text.count("| failed ") == 2
    assert "wheels:50 failed: the simulator ended with status 1: no" in text and "wheels:1 failed: no master" in text
    assert "left out" not in text


def test_a_busy_client_and_a_missed_factor_are_noted():
    result = Measured(
        Case("wheels", 50),
        [Floor(2.0, 0.4, 1e-3, 1e-3, 1e-6)],
        [Run(1.2, 0.9, 1, 1.0, 10, 10, 0.97)],
        [Run(0.8, 1.1, 1, 1.0, 10, 10, 0.1)],
    )
    assert "client was busy" in result.notes()[0] and "only 0.80 of" in result.notes()[1]


def test_json_has_every_run_and_the_medians():
    document = json.loads(
        report.as_json([measured(Case("kinematic", 1)), Measured(Case("wheels", 1), error="no")], WHERE)
    )
    first, second = document["cases"]
    assert (first["median"]["factor"], first["lost"], len(first["paced"])) == (540.0, 15, 3)
    assert (second["error"], second["median"], second["floors"]) == ("no", {}, [])
    assert document["conditions"]["repeats"] == 3
