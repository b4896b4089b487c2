"""Control programs as text, in the language of .golog files, and their translation."""

from golog_programs import PROCEDURES

from rosoclingo.golog import translate


def translated(programs):
    """Return the rules of a step ``t`` for programs by name, and for the procedures that they can call."""
    procedures = {**{name: ((), program) for name, program in programs.items()}, **PROCEDURES}
    text = "\n".join(_procedure(name, *parts) for name, parts in procedures.items())
    return translate(text, "main.golog").text.replace("_step", "t")


def _procedure(name, parameters, body):
    return f"proc {name}{'(' + ', '.join(parameters) + ')' if parameters else ''} {{ {statement(body)} }}"


#: The words before a block, and between two blocks.
WORDS = {
    "choice": ("choose", " or "),
    "conc": ("interleave", " with "),
    "prio": ("prefer", " over "),
    "order": ("any order", " and "),
    "star": ("star", ""),
    "search": ("search", ""),
    "try": ("try", " else "),
    "undoing": ("do", " on cancel "),
}


def statement(one):
    """Return a program as statements."""
    kind, *parts = one
    if kind == "prio" and parts[0][0] == "every":
        return f"interrupts {{ when {chosen(*parts[0][1:])} }} until {condition(parts[1][1])};"
    if kind in WORDS:
        parts = parts[0] if kind == "order" else parts
        return WORDS[kind][0] + blocks(parts, WORDS[kind][1]) if parts[1:] or kind != "order" else statement(parts[0])
    if kind == "retry":
        return f"retry {parts[0]}{blocks(parts[1:], '')}"
    if kind in ("if", "while"):
        return f"{kind} {condition(parts[0])}{blocks(parts[1:], ' else ')}"
    if kind == "pick":
        return f"pick {chosen(*parts)}"
    return simple(kind, *parts)


def chosen(variable, values, asked, body):
    """Return a program for each value of a variable that satisfies a condition."""
    values = ", ".join(map(str, values))
    return f"{variable}: {condition(asked)} and {variable} in {{{values}}} {{ {statement(body)} }}"


def blocks(parts, between):
    """Return programs in brackets."""
    return " " + between.join(f"{{ {statement(part)} }}" for part in parts)


def simple(kind, *parts):
    """Return a program of one statement, or of two in sequence."""
    if kind == "seq":
        return f"{statement(parts[0])} {statement(parts[1])}"
    if kind in ("test", "await"):
        return f"{kind} {condition(parts[0])};"
    if kind == "call":
        return atom((parts[0], *parts[1])) + ";"
    return {"nil": "", "any": "any;"}[kind] if kind in ("nil", "any") else atom(parts[0]) + ";"


def condition(one):
    """Return a condition, in brackets if it has parts."""
    kind = one[0]
    if kind == "not":
        return f"not {condition(one[1])}"
    if kind in ("and", "or"):
        return f"({condition(one[1])} {kind} {condition(one[2])})"
    if kind == "some":
        return f"(some {one[1]}: {condition(one[3])} and {one[1]} in {{{', '.join(map(str, one[2]))}}})"
    if kind == "less":
        return f"{one[1]} < {one[2]}"
    return atom(one)


def atom(one):
    """Return an action or a fluent as text."""
    arguments = [f"{part[1]} - {part[2]}" if isinstance(part, tuple) else str(part) for part in one[1:]]
    return one[0] + (f"({', '.join(arguments)})" if arguments else "")
