"""What a node under the agent publishes, hears and calls is on the wire, in no simulated time."""

import pytest
from agent_program import STEP, Program
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from robocop_grading.agent import wire
from robocop_grading.session.topics import header

PARAMETERS = {"/use_sim_time": True, "/rosout_disable_topics_generation": True, "/speed": 0.2}
OFFERED = [
    header(Float64, topic="/first", latching="0"),
    header(Float64, topic="/second", latching="0"),
    header(Float64, topic="/latched", latching="1"),
    header(Float64, topic="/out"),
    header(Trigger, service="/trigger"),
]
BEGIN = """
import rospy, sys
from std_msgs.msg import Float64, String
from std_srvs.srv import Trigger, TriggerResponse
rospy.init_node("node")
def tell(*words): print(*words, round(time.monotonic() - start, 3), flush=True)
"""


def number(value):
    """A serialized Float64, with its length."""
    return wire.LENGTH.pack(8) + wire.struct.pack("<d", value)


def text(words):
    return wire.LENGTH.pack(len(words)) + words.encode()


def lived(folder, program, messages=(), answer=b""):
    """What a node has printed and published after it has got these messages, each list in a turn of its own."""
    with Program(folder, BEGIN + program, PARAMETERS, OFFERED, answer) as node:
        for turn, sent in enumerate([[], *messages, []], 1):
            node.go_on(turn * STEP, 0, [(topic, number(value)) for topic, value in sent])
        node.process.kill()
        return node.process.stdout.read().splitlines(), [data for topic, data in node.published if topic == "/out"]


@pytest.mark.parametrize(
    "program, messages, printed",
    [
        pytest.param(
            "for topic in ('/second', '/first'):\n"
            "    rospy.Subscriber(topic, Float64, lambda m, name: tell(name, m.data), topic)\nrospy.spin()",
            [[("/first", 1.0), ("/second", 2.0), ("/first", 3.0)]],
            ["/first 1.0 0.02", "/first 3.0 0.02", "/second 2.0 0.02"],
            id="topics have their turns in the order in which they are sent",
        ),
        pytest.param(
            "time.sleep(0.025)\nrospy.Subscriber('/latched', Float64, lambda m: tell(m.data))\n"
            "rospy.Subscriber('/latched', Float64, lambda m: tell('second', m.data))\nrospy.spin()",
            [[("/latched", 1.0)], [], [("/latched", 2.0)]],
            ["1.0 0.025", "second 1.0 0.025", "2.0 0.04", "second 2.0 0.04"],
            id="a latched message comes to a later subscriber",
        ),
        pytest.param(
            "rospy.Subscriber('/first', String, tell)\nrospy.spin()",
            [[("/first", 1.0)]],
            [],
            id="of a wrong type nothing",
        ),
        pytest.param(
            "def slow(m):\n    tell(m.data)\n    time.sleep(0.022)\n"
            "rospy.Subscriber('/first', Float64, slow, queue_size=1)\nrospy.spin()",
            [[("/first", float(value))] for value in range(5)],
            ["0.0 0.02", "2.0 0.042", "4.0 0.064"],
            id="of what has come during a slow callback the last queue_size messages are kept",
        ),
        pytest.param(
            "rospy.Subscriber('~own', String, lambda m: tell(m.data))\n"
            "own = rospy.Publisher('~own', String, queue_size=1)\ntime.sleep(0.001)\n"
            "for word in 'abc': own.publish(word)\ntell('published')\nrospy.spin()",
            [],
            ["published 0.001", "a 0.001", "b 0.001", "c 0.001"],
            id="a node's own topic comes back in order",
        ),
        pytest.param(
            "rospy.Service('~own', Trigger, lambda _: TriggerResponse(True, 'own'))\nrospy.wait_for_service('~own')\n"
            "tell(rospy.ServiceProxy('~own', Trigger)().message)\nrospy.wait_for_service('/trigger')\n"
            "tell(rospy.ServiceProxy('/trigger', Trigger)().message)",
            [],
            ["own 0.0", "answer 0.0"],
            id="services are called",
        ),
        pytest.param(
            "for _ in range(1500):\n    rospy.wait_for_service('/trigger')\n    time.sleep(0.001)\ntell('all')",
            [[]] * 160,
            ["all 1.5"],
            id="a service may be waited for in each loop",
        ),
        pytest.param(
            "tell(rospy.get_param('/speed'), [name for name, _ in rospy.get_published_topics()])\n"
            "rospy.set_param('~a', {'b': 1})\n"
            "tell(rospy.get_param('~a/b'), rospy.get_param_cached('/node/a/b'), rospy.has_param('/none'))",
            [],
            ["0.2 ['/first', '/second', '/latched', '/rosout'] 0.0", "1 1 False 0.0"],
            id="the master knows parameters and topics",
        ),
        pytest.param(
            "import os, xmlrpc.client\nmaster = xmlrpc.client.ServerProxy(os.environ['ROS_MASTER_URI'])\n"
            "for name in ('shutdown', '_shutdown', 'param_update_task', 'system.listMethods'):\n"
            "    try: getattr(master, name)('/node')\n"
            "    except xmlrpc.client.Fault as fault: tell(fault.faultString.partition(':')[2])\n"
            "tell(rospy.get_master().getPid()[0])",
            [],
            [
                'method "shutdown" is not supported 0.0',
                'method "_shutdown" is not supported 0.0',
                'method "param_update_task" is not supported 0.0',
                'method "system.listMethods" is not supported 0.0',
                "1 0.0",
            ],
            id="the master answers nothing but the methods of its API",
        ),
    ],
)
def test_a_node_hears_in_no_simulated_time(program, messages, printed, tmp_path):
    answer = b"\1" + wire.LENGTH.pack(11) + b"\1" + text("answer")
    lines, _ = lived(tmp_path, program, messages, answer)
    assert [line for line in lines if not line.startswith("[")] == printed


@pytest.mark.parametrize(
    "program, expected",
    [
        pytest.param("time.sleep(0.001)\nfor n in (1, 2): out.publish(n)", [1.0, 2.0], id="in order"),
        pytest.param("out.publish(1)\ntime.sleep(0.001)\nout.publish(2)", [2.0], id="not before it is connected"),
        pytest.param(
            "out = rospy.Publisher('/out', Float64, latch=True, queue_size=1)\nout.publish(1)\ntime.sleep(0.001)",
            [1.0],
            id="what is latched when it is connected",
        ),
        pytest.param(
            "import os\ntime.sleep(0.001)\nout.publish(1)\nos._exit(0)",
            [1.0],
            id="last words",
        ),
        pytest.param(
            "import multiprocessing\ntime.sleep(0.001)\n"
            "child = multiprocessing.get_context('fork').Process(target=out.publish, args=(3,))\n"
            "child.start()\nchild.join()",
            [3.0],
            id="of a forked child",
        ),
    ],
)
def test_what_a_node_publishes_arrives_before_its_turn_is_over(program, expected, tmp_path):
    begin = "out = rospy.Publisher('/out', Float64, queue_size=10)\n"
    _, published = lived(tmp_path, f"{begin}{program}\nrospy.spin()\n", [[]] * 20)
    assert published == [number(value) for value in expected]


def test_a_node_without_init_node_has_no_topics(tmp_path):
    text = "import rospy\nfrom std_msgs.msg import Float64\nrospy.Publisher('/out', Float64, queue_size=1)\n"
    with Program(tmp_path, f"{text}rospy.get_param('/speed')\ntime.sleep(60)", PARAMETERS, OFFERED) as node:
        node.go_on(STEP)
        assert node.told == {"published": [], "subscribed": [], "programs": [], "delays": []}


@pytest.mark.parametrize(
    "start, programs",
    [
        ("os.system('rostopic list')", ["rostopic"]),
        ("subprocess.run(['rosparam', 'get', '/a'])", ["rosparam"]),
        ("os.fork() or os._exit(0)", ["other Python processes"]),
    ],
)
def test_grader_is_told_of_topics_and_of_programs_that_find_no_master(start, programs, tmp_path):
    program = f"import os, subprocess\nrospy.Subscriber('/first', String)\n{start}\ntell('done')\nrospy.spin()"
    with Program(tmp_path, BEGIN + program, PARAMETERS, OFFERED) as node:
        for turn in range(1, 100):
            node.go_on(turn * STEP)
            if node.told.get("programs"):
                break
        assert node.told["programs"] == programs
        assert [[name, kind] for name, _, kind in node.told["subscribed"]] == [["/first", "std_msgs/String"]]


def test_grader_is_told_how_long_messages_wait_for_a_slow_callback(tmp_path):
    program = "rospy.Subscriber('/first', Float64, lambda m: time.sleep(0.6))\nrospy.spin()"
    with Program(tmp_path, BEGIN + program, PARAMETERS, OFFERED) as node:
        told = []
        for turn in range(1, 70):
            node.go_on(turn * STEP, 0, [("/first", number(1.0))] if turn > 1 else [])
            told.append(node.told.get("delays", []))
    assert told[0] == [] and told[-1] == [["/first", 0.5]], told
