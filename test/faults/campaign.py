#!/usr/bin/env python3
"""A campaign of faults against one ROS system, chosen by a seed; prints a table and every violation.

Each episode draws a fault and its figures from seed, configuration and its own number alone, so --episode repeats it
(up to the timing of processes). After each fault these have to hold, for every robot:

- each goal has exactly one result and one terminal state, which agree, with a known word and a text;
- the robot is at rest one simulated second after its last goal, and stays so;
- a goal nearby is then reached, although nothing was restarted but what the fault had ended;
- no process has ended by itself or logged a traceback;
- at the end no process uses many more megabytes, threads or file descriptors than after the first episodes.
"""

import argparse
import collections
import json
import random
import re
import statistics
import sys
import time
from pathlib import Path

import data_faults  # noqa: F401  these three register their faults
import neighbour_faults  # noqa: F401
import process_faults  # noqa: F401
import rospy
from client import Client
from faults import FAULTS
from stage import MessageStage, SimulatedStage
from system import CLIENT, System, Violation

from aro_robocop_goto_as.process.signals import interrupt_on_signal

KINEMATIC = {"drive": "kinematic", "physics_rate": 60, "imu_rate": 10}
BULLET = {"drive": "wheels", "physics_rate": 240}
COARSE = {"clock_rate": 10, "odom_rate": 10, "joint_state_rate": 10, "ground_truth_rate": 10, "bumper_rate": 0}
LOCKSTEP = {"sync": "lockstep", "real_time_factor": 0.0}
FREE = {"sync": "free", "real_time_factor": 3.0}  # a busy machine has to send a command each 0.5 s of it
TWO = {"robots": "left 0 3; right 0 -3"}
WORLD = {"world": "empty", "seed": 1}
CONFIGURATIONS = {
    f"{mode}-{drive}-{place}": {**WORLD, **COARSE, **how, **engine, **where}
    for mode, how in (("lockstep", LOCKSTEP), ("free", FREE))
    for drive, engine in (("kinematic", KINEMATIC), ("wheels", BULLET))
    for place, where in (("one", {}), ("two", TWO), ("pillars", {"world": "world"}), ("maze", {"world": "maze_1"}))
}
MESSAGES = "messages"  # the configuration without a simulator
IN_THE_WAY = ("OBSTACLE", "STUCK")  # how any goal may end in a world with obstacles, but not the one after the fault
WARM_UP = 5  # episodes before usage is noted
GROWTH = {"RSS [MiB]": 40.0, "threads": 6, "file descriptors": 12}  # that is no leak in a few hundred goals
GIVEN_BACK = 10.0  # [s, wall] for what the last fault's connections used; rospy looks for closed ones twice a second
SOAK_ROWS = 12  # of the table of a soak test
SOAK_GROWTH = {"RSS [MiB]": 4.0, "threads": 1, "file descriptors": 2}  # from its second third to its last one
COSTLY_SHARE = 0.05  # of the episodes, after each fault had its turn


class Episode:
    """One fault and what it may touch."""

    def __init__(self, name, campaign):
        self.name = name
        self.rng = random.Random(name)
        self.system, self.stage, self.clients = campaign.system, campaign.stage, campaign.clients
        self.client = self.rng.choice(self.clients)
        self.factor, self.full = campaign.factor, campaign.full


class Campaign:
    """Episodes in one configuration."""

    def __init__(self, configuration, seed, full, verbose, select, system):
        simulator = None if configuration == MESSAGES else CONFIGURATIONS[configuration]
        robots = ["left", "right"] if simulator and "robots" in simulator else [""]
        self.configuration, self.seed, self.full, self.verbose = configuration, seed, full, verbose
        self.factor = simulator["real_time_factor"] if simulator else 0.0
        self.system = system
        system.start_nodes(robots, simulator)
        rospy.init_node(CLIENT[1:], disable_rostime=True, disable_signals=True)
        lockstep = simulator is not None and simulator["sync"] == "lockstep"
        self.obstacles = simulator is not None and simulator["world"] != WORLD["world"]
        self.clients = [Client(self.system, robot, self.obstacles, lockstep) for robot in robots]
        self.stage = (SimulatedStage if simulator else MessageStage)(self.system, self.clients)
        kinds = ["", "simulator" if simulator else "messages"]
        if robots == [""]:
            kinds += ["bridge"]
        self.faults = [fault for fault in FAULTS if fault.needs in kinds and re.match(select, fault.name)]
        self.last = [fault for fault in FAULTS if fault.needs == "last" and re.match(select, fault.name)]
        self.table = collections.defaultdict(collections.Counter)
        self.violations = []
        self.noted = []  # during a soak test: time since its start [s, wall], goals, usage
        self.baseline = None

    def fault_of(self, number):
        """The fault of an episode: each has its turn in a random order, then they are drawn."""
        if number < len(self.faults):
            return random.Random(f"{self.seed}/{self.configuration}").sample(self.faults, len(self.faults))[number]
        rng = random.Random(f"{self.seed}/{self.configuration}/fault {number}")
        costly = rng.random() < COSTLY_SHARE
        return rng.choice([fault for fault in self.faults if fault.costly == costly] or self.faults)

    def run(self, goals):
        """Each fault once, then episodes until so many goals have been sent; then the last ones."""
        self.stage.prepare()
        number = 0
        while (self.goals_sent < goals or number < len(self.faults)) and not self.violations:
            fault = self.fault_of(number)
            if self.full or not fault.costly or number >= len(self.faults):
                self.run_episode(number, fault)
            number += 1
            if number == WARM_UP:
                self.baseline = self.system.usage()
        if not self.violations and self.baseline is not None:
            self._guard("usage", self.require_level_usage)
        for fault in self.last if self.full else []:
            if not self.violations:
                self.run_episode(number, fault)

    def soak(self, seconds):
        """Goals without faults for so long [s, wall]; usage is noted SOAK_ROWS times, and must stay level."""
        self.stage.prepare()
        (fault,) = (fault for fault in FAULTS if fault.name == "valid_goals")
        begun, number, noted = time.monotonic(), 0, self.noted
        while len(noted) <= SOAK_ROWS and not self.violations:
            self.run_episode(number, fault)
            number += 1
            elapsed = time.monotonic() - begun
            if number >= WARM_UP and elapsed >= len(noted) * seconds / SOAK_ROWS:
                noted.append((elapsed, self.goals_sent, self.system.usage()))
                self.baseline = noted[0][2]
                self._guard("usage", self.require_level_usage)
        if not self.violations:
            self._guard("usage", lambda: _require_no_slope([used for _, _, used in noted]))

    @property
    def goals_sent(self):
        """How many goals have been sent so far."""
        return sum(client.sent for client in self.clients)

    def run_episode(self, number, fault=None):
        """One episode, with its invariants."""
        fault = fault or self.fault_of(number)
        before, row = self.goals_sent, self.table[fault]
        name = f"{self.configuration}/{self.seed}/{number}"
        begun = time.monotonic()
        self._guard(f"{name} ({fault.text})", lambda: self._play(Episode(name, self), fault, row))
        if self.verbose:
            print(f"{time.monotonic() - begun:6.2f} s  {name} {fault.name}", file=sys.stderr, flush=True)
        row["episodes"] += 1
        row["goals"] += self.goals_sent - before

    def _guard(self, name, action):
        try:
            action()
        except (Violation, rospy.ServiceException, OSError) as error:
            self.violations.append(f"{name}: {type(error).__name__}: {error}")

    def _play(self, episode, fault, row):
        self.stage.begin_episode()
        words = fault.run(episode)
        self._settle()
        for client in self.clients:
            for goal in client.expected:
                if not client.results[goal]:
                    row["lost with their server"] += 1
                    continue
                word = client.word(goal)
                row[word] += 1
                if words is not None and word not in (*words, *(IN_THE_WAY if self.obstacles else ())):
                    raise Violation(f"goal {goal} ended {client.results[goal][0].result.message!r}, expected {words}")
        for client in self.clients:
            probe = self._probe(episode, client)
            if fault.group == "cancel" and client.word(probe) == "PREEMPTED":
                # Cancels and goals come over two connections: one for all goals may arrive after the probe.
                row["PREEMPTED"] += 1
                probe = self._probe(episode, client)
            if client.word(probe) != "REACHED":
                raise Violation(f"the goal after it ended {client.results[probe][0].result.message!r}")
            row["REACHED"] += 1
        for client in self.clients:
            client.forget()

    def _probe(self, episode, client):
        """A goal nearby that nothing disturbs, once it has ended."""
        if client.place_near(episode.rng, 0.3, free=True) is None:
            self.stage.send_home()
        probe = client.send_near(episode.rng, 0.3)
        self.stage.wait_for(client.all_ended, "the end of the goal after it")
        client.require_one_ending_each()
        return probe

    def _settle(self):
        for client in self.clients:
            self.stage.wait_for(client.all_ended, lambda c=client: f"results of {_missing(c)}")
        self.stage.require_rest()
        for client in self.clients:
            client.require_one_ending_each()
        self.system.require_health()

    def require_level_usage(self):
        """Violation if a process that runs since the warm-up keeps using much more than then."""
        self.stage.wait_for(lambda: self._growth() is None, self._growth, GIVEN_BACK)

    def _growth(self):
        """What grew beyond its limit, in words; None: nothing."""
        used = self.system.usage()
        for name, (pid, *before) in self.baseline.items():
            now_pid, *now = used[name]
            for (what, limit), old, new in zip(GROWTH.items(), before, now):
                if pid == now_pid and new - old > limit:
                    return f"{name}: {what} grew from {old:g} to {new:g}"
        return None


def _require_no_slope(noted):
    """Violation if a process uses more in the last third of a soak test than in the second one, by their medians.

    In the first third memory may still grow to the size that is needed.
    """
    third = len(noted) // 3
    for name in noted[0]:
        middle, last = ([used[name][1:] for used in part] for part in (noted[third:-third], noted[-third:]))
        for (what, limit), before, after in zip(SOAK_GROWTH.items(), zip(*middle), zip(*last)):
            old, new = statistics.median(before), statistics.median(after)
            if new - old > limit:
                raise Violation(f"{name}: {what} is still growing after a third of the time, from {old:g} to {new:g}")


def _missing(client):
    return [goal for goal in client.expected if goal not in client.lost and not client.results[goal]]


def table_text(table):
    """The results by fault, as lines of a table."""
    words = sorted({word for row in table.values() for word in row} - {"episodes", "goals"})
    lines = [f"| fault | episodes | goals | {' | '.join(words)} |", "| --- |" + " --- |" * (len(words) + 2)]
    for fault in sorted(table, key=lambda fault: (fault.group, fault.name)):
        row = table[fault]
        counts = " | ".join(str(row[word] or "") for word in ("episodes", "goals", *words))
        lines.append(f"| {fault.group}: {fault.text} | {counts} |")
    total = sum(table.values(), collections.Counter())
    lines.append("| all | " + " | ".join(str(total[word]) for word in ("episodes", "goals", *words)) + " |")
    return "\n".join(lines)


def usage_text(noted):
    """What each process used during a soak test, as lines of a table."""
    names = list(noted[0][2])
    lines = [f"| minute | goals | {' | '.join(names)} |", "| --- |" + " --- |" * (len(names) + 1)]
    for elapsed, goals, used in noted:
        cells = (f"{rss:.1f} MiB, {threads} threads, {files} files" for _, rss, threads, files in map(used.get, names))
        lines.append(f"| {elapsed / 60.0:.0f} | {goals} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main():
    """Run the campaign; exit status 1 if an invariant was violated."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--configuration", choices=[*CONFIGURATIONS, MESSAGES], default=MESSAGES)
    parser.add_argument("--goals", type=int, default=100, help="how many goals at least")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--select", default="", help="a regular expression that the names of the faults have to match")
    parser.add_argument("--full", action="store_true", help="also the faults that take seconds, and whole bursts")
    parser.add_argument("--episode", type=int, help="only this episode")
    parser.add_argument("--soak", type=float, help="instead of faults, goals for so many seconds")
    parser.add_argument("--mistake", help="start the server of broken_server.py with this mistake")
    parser.add_argument("--verbose", action="store_true", help="print each episode with its duration")
    parser.add_argument("--folder", type=Path, required=True, help="for logs")
    options = parser.parse_args()
    interrupt_on_signal()  # so that no process of the system is left over
    started = time.monotonic()
    system = System(options.folder, options.mistake)
    try:
        campaign = Campaign(options.configuration, options.seed, options.full, options.verbose, options.select, system)
        try:
            if options.soak is not None:
                campaign.soak(options.soak)
            elif options.episode is None:
                campaign.run(options.goals)
            else:
                campaign.stage.prepare()
                campaign.run_episode(options.episode)
        except KeyboardInterrupt:
            campaign.violations.append("interrupted; the tables hold what was done until then")
    finally:
        rospy.signal_shutdown("the campaign is over")
        system.close()
    if options.soak is not None:
        print(usage_text(campaign.noted) if campaign.noted else "ended before the first look at the processes")
    print(table_text(campaign.table))
    print(f"{campaign.goals_sent} goals, {time.monotonic() - started:.0f} s, seed {options.seed}")
    print(*campaign.violations, sep="\n")
    counts = {fault.name: dict(row) for fault, row in campaign.table.items()}
    report = {"goals": campaign.goals_sent, "violations": campaign.violations, "faults": counts}
    (options.folder / "report.json").write_text(json.dumps(report))
    sys.exit(1 if campaign.violations else 0)


if __name__ == "__main__":
    main()
