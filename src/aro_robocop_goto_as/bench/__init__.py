"""./robocop bench: one table of the simulator's speed, its cost, and the speed of its bare parts (the floor).

cases       command line arguments -> the simulations to measure
frames      bytes of a topic's connection -> number of messages, stamps of the first and the last
subscribe   topics -> connections to their publishers, by ROS's protocol but without rospy
drain       the client, a process: connections -> counts of messages
processes   master, simulator, client as child processes
floor       the same physics, rays and bytes in a bare loop, a process
measure     one repeat of a case -> Run, Floor
results     Run, Floor, and all repeats of a case
report      results -> table or JSON
rospy_loop  the controller of a lockstep case, a process: a plain rospy loop
goal_loop   the client of the action server in a lockstep case, a process: one goal after another
against     another checkout's simulator and this one alternately -> ratios
main        the command
"""
