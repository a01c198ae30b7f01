"""Publishing with direct sockets: no message is lost to a subscriber that reads, and one step is one call of C.

Only this folder uses rospy's insides to publish. A rospy.Publisher with a queue drops messages and has a thread for
each subscriber. A publisher without a queue closes the connection of a slow subscriber in the middle of a message. It
also runs, for each message and each subscriber, about as much Python to reach the socket as to make the message.

The rule: each message is written before the next step is simulated. A subscriber that does not read for STALL_TIMEOUT
is marked, with one warning, and misses whole messages until it reads again. It stays connected, as rospy's subscribers
do not return to a publisher that has closed the connection.

publisher        advertises a topic, and knows its subscribers' sockets: which messages each one misses, and the rest of
                 a message that it took in part
packed           messages that are serialized once, and then filled by batch.c
batch            the messages of one step: batch.c fills and sends them all
rospy_internals  the private parts of rospy that are used here
"""
