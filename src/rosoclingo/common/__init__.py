"""What all layers share: labels, parameters, the worker thread, names that load late.

Some modules change the behaviour of rospy and actionlib, each for promises of doc/reliability.md:

* prompt_publisher: cancels, results and returns leave before their node ends; an interface hears of the run first.
* action_servers: goals and their status survive when simulated time goes back.
* registration: a master that was restarted knows the nodes again; publishers that rospy misses are connected.
* streams: a full disk, or a locale without a character, costs no more than the text.
"""
