"""Random control programs in a small domain."""

from hypothesis import strategies as st

FLUENTS = (("f",), ("g",), ("h", 1), ("h", 2))
ACTIONS = (("a",), ("b",), ("c",), ("e", 1), ("e", 2))


class Toy:
    """The domain: a makes f true; b, possible with f, false; c turns g; e(N) makes h(N) true, e(1) without g."""

    actions = ACTIONS

    @staticmethod
    def possible(action, state):
        """Return whether an action is possible in a state."""
        return {"b": ("f",) in state, "e": action != ("e", 1) or ("g",) not in state}.get(action[0], True)

    @staticmethod
    def after(action, state):
        """Return the state after an action."""
        if action[0] == "c":
            return state ^ {("g",)}
        added = {"a": {("f",)}, "e": {("h", *action[1:])}}.get(action[0], set())
        return (state | added) - ({("f",)} if action[0] == "b" else set())


#: The same domain for the encoding; ``event(F,V,t)`` sets fluent F to true or false before the step.
TOY = """
#program base.
golog_does(a,act,a). golog_does(b,act,b). golog_does(c,act,c).
golog_does(e(1),act,e(1)). golog_does(e(2),act,e(2)).
#program cumulative(t).
golog_action(A,N,X,t) :- golog_does(A,N,X), not out(A,t).
out(b,t)    :- not holds(f,t).
out(e(1),t) :- holds(g,t).
acts(A,t)   :- golog_does(A,N,X), _action_lib(N,X,t), not _g_failing(A,t).
after(f,t)    :- holds(f,t), not acts(b,t).
after(f,t)    :- acts(a,t).
after(g,t)    :- holds(g,t), not acts(c,t).
after(g,t)    :- acts(c,t), not holds(g,t).
after(h(N),t) :- holds(h(N),t), N = 1..2.
after(h(N),t) :- acts(e(N),t), N = 1..2.
holds(F,t)    :- after(F,t-1), not event(F,no,t).
holds(F,t)    :- event(F,yes,t), fluent(F).
golog_holds(F,t) :- holds(F,t).
:- 2 { _action_lib(A,X,t) }.
#program base.
fluent(f). fluent(g). fluent(h(1..2)).
"""

# ---- random programs -------------------------------------------------------------------------------------------------

conditions = st.recursive(
    st.sampled_from(FLUENTS) | st.just(("less", 0, 1)),
    lambda c: st.tuples(st.just("not"), c) | st.tuples(st.sampled_from(["and", "or"]), c, c),
    max_leaves=3,
)
with_x = conditions | st.sampled_from([("h", "X"), ("not", ("h", "X")), ("less", 1, "X")])
leaves = (
    st.tuples(st.just("do"), st.sampled_from(ACTIONS))
    | st.tuples(st.sampled_from(["test", "await"]), conditions)
    | st.sampled_from([("nil",), ("any",)])
)
inner = st.tuples(st.just("do"), st.sampled_from([*ACTIONS, ("e", "X")])) | st.tuples(st.just("test"), with_x)


chosen = st.just("X"), st.just((1, 2)), with_x


def larger(p):
    """Generate programs made of others."""
    x = st.tuples(st.just("seq"), inner, p) | inner
    return st.one_of(
        st.tuples(st.sampled_from(["seq", "choice", "conc", "prio", "try", "undoing"]), p, p),
        st.tuples(st.just("seq"), p, p),
        st.tuples(st.just("if"), conditions, p, p),
        st.tuples(st.just("while"), conditions, p),
        st.tuples(st.sampled_from(["star", "search"]), p),
        st.tuples(st.just("order"), st.lists(p, min_size=1, max_size=3).map(tuple)),
        st.tuples(st.just("retry"), st.integers(0, 2), p),
        st.tuples(st.just("pick"), *chosen, x),
        st.tuples(st.just("prio"), st.tuples(st.just("every"), *chosen, x), st.tuples(st.just("await"), conditions)),
    )


def programs():
    """Generate programs; calls refer to these procedures, in which an action precedes any call."""
    call = st.just(("call", "p", ())) | st.tuples(st.just("call"), st.just("q"), st.sampled_from([(1,), (2,)]))
    return st.recursive(leaves | call, larger, max_leaves=6)


#: Procedures with recursive bodies: p of any length, q down from a number.
PROCEDURES = {
    "p": ((), ("seq", ("do", ("c",)), ("choice", ("nil",), ("seq", ("call", "p", ()), ("do", ("a",)))))),
    "q": (
        ("N",),
        ("seq", ("do", ("e", "N")), ("if", ("less", 1, "N"), ("call", "q", (("minus", "N", 1),)), ("nil",))),
    ),
}
