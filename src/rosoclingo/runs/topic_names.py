"""Names of a core's topics: private topics, topics of its action server, and topics shared with interfaces."""

#: The default name of the core, and the name of each core's action server.
USUAL = "rosoclingo"


def full_name(topic: str, core: str) -> str:
    """Return the name of a topic for a core: absolute if the core's name is absolute, else relative.

    A topic with ``~`` is private to the core, a topic with ``/`` is global, any other is in the core's namespace.
    """
    if topic.startswith("/"):
        return topic
    namespace, slash, _ = core.rpartition("/")
    return f"{core}/{topic[1:]}" if topic.startswith("~") else namespace + slash + topic
