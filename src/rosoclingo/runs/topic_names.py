"""The names of a core's topics: its own, those of its action server, and those that it shares with interfaces."""

__all__ = ["USUAL", "full_name"]

#: The core's usual name, and the name of each core's action server.
USUAL = "rosoclingo"


def full_name(topic: str, core: str) -> str:
    """Return the name of a topic for a core: a full one where the core's is, else a relative one.

    One that begins with ``~`` is the core's own, one with ``/`` nobody's, and any other is in the core's namespace.
    """
    if topic.startswith("/"):
        return topic
    namespace, slash, _ = core.rpartition("/")
    return f"{core}/{topic[1:]}" if topic.startswith("~") else namespace + slash + topic
