"""Texts from outside: how long they may be, and how they are told in a message."""

#: Characters of one goal or one fact.
LONGEST = 65536

#: Facts of one message.
MOST_FACTS = 1000

#: Facts that may wait for the next update, returns not counted.
MOST_WAITING = 10000

#: Characters of a text that a message repeats, half of them from each end.
SHOWN = 200


def shortened(text: str, shown: int = SHOWN) -> str:
    """The text without its middle, if it is long: whoever has sent a megabyte need not read it again."""
    if len(text) <= shown:
        return text
    return f"{text[: shown // 2]} ... {text[-(shown // 2) :]} ({len(text)} characters)"
