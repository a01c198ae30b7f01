"""./robocop bench: how fast the simulator is, what it costs, how fast its bare parts would be; as one table.

    cases       words of the command line -> which simulations to measure
    frames      bytes of a topic's connection -> messages counted, stamps of the first and the last
    subscribe   topics -> connections to their publishers, by ROS's own protocol and without rospy
    drain       the client, a process: connections -> what has arrived
    processes   master, simulator, client: started, watched, ended
    floor       the same physics, rays and bytes with nothing around them, a process
    measure     a case, once -> Run, Floor
    results     Run, Floor, all repeats of a case
    report      all of that -> table or JSON
    main        the command
"""
