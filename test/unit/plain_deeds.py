"""What plans do, as text: "go a; take (1,a)"."""

from rosoclingo.oclingo import parse_term


def deeds_of(text):
    """Kinds and parameters."""
    return [tuple(map(parse_term, one.split(" ", 1))) for one in text.split("; ") if one]


def text_of(deeds):
    """The same as text."""
    return "; ".join(f"{kind} {what}" for kind, what in deeds)
