"""Modules shared by all layers: labels, parameters, the worker thread, lazy imports.

Some modules change the behaviour of rospy and actionlib, for the guarantees of doc/reliability.md:

* prompt_publisher: sends cancels, results and returns before the node ends, and the run to interfaces first.
* action_servers: keeps goals and their status when simulated time goes back.
* registration: registers the node again at a restarted master, and connects to publishers that rospy missed.
* streams: lets a full disk, or a locale that lacks a character, only lose text.
"""
