#!/usr/bin/env python3
"""Counts the messages of some topics. Usage: count_messages.py COUNTS.json TOPIC..."""

import json
import os
import sys
import threading

import rospy


def main():
    rospy.init_node("count_messages", disable_rostime=True)
    path, topics = sys.argv[1], sys.argv[2:]
    counts = dict.fromkeys(topics, 0)
    lock = threading.Lock()  # each topic has its own thread

    def on_message(_message, topic):
        with lock:
            counts[topic] += 1
            with open(path + ".new", "w") as output:
                json.dump(counts, output)
            os.replace(path + ".new", path)

    for topic in topics:
        rospy.Subscriber(topic, rospy.AnyMsg, on_message, topic)
    open(path + ".ready", "w").close()
    rospy.spin()


if __name__ == "__main__":
    main()
