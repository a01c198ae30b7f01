"""./robocop bench: measures the simulator's speed and cost, and compares it with the same simulator without ROS.

cases        command line arguments -> the simulations to measure
worlds       the world files of some cases
client       topics -> counts of messages: how many came, how many were lost; drain.c reads and counts
processes    master, simulator and others as child processes
checkout     where the programs of this and of another checkout are
measure      one simulation of a case -> Run
baseline     the simulator of a case without ROS -> figures
controllers  the controllers of lockstep cases, a process: a plain rospy loop, one goal after another
report       all repeats of a case -> table or JSON; those of two checkouts -> ratios
main         the command
"""
