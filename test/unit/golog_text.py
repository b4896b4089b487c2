"""Random control programs as text, in the language of .golog files."""

from golog_programs import PROCEDURES


def program_text(name, program):
    """Return a file with a procedure that is this program, and the procedures that it can call."""
    texts = [_procedure(name, (), program), *(_procedure(one, *parts) for one, parts in PROCEDURES.items())]
    return "\n".join(texts)


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
    if kind in WORDS:
        parts = parts[0] if kind == "order" else parts
        return WORDS[kind][0] + blocks(parts, WORDS[kind][1]) if parts[1:] or kind != "order" else statement(parts[0])
    if kind == "retry":
        return f"retry {parts[0]}{blocks(parts[1:], '')}"
    if kind in ("if", "while"):
        return f"{kind} {condition(parts[0])}{blocks(parts[1:], ' else ')}"
    if kind in ("pick", "every"):
        variable, values, asked, body = parts
        head = f"{variable}: {condition(asked)} and {variable} in {{{', '.join(map(str, values))}}}"
        body = f"{head} {{ {statement(body)} }}"
        return f"pick {body}" if kind == "pick" else f"prefer {{ interrupts {{ when {body} }} until true; }} over {{ }}"
    return simple(kind, *parts)


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
