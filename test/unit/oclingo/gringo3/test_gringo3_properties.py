"""Properties of the translation of any text, and answers of random programs against a model of gringo 3."""

import itertools
import operator

from gringo3_answers import answers, solve, translated
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.oclingo.gringo3 import Dialect, TranslationError, translate
from rosoclingo.oclingo.gringo3.lexer import tokens

PIECES = """p q(X) r(1,2) -p not X Y _ 1 23 "s" f(a,_) , ; : :- . .. | ( ) { } [ ] + - * / \\ ** & ? ^ ~ @ = := == != <
    <= > >= ;; #hide #show #const #domain #base #cumulative #volatile #external #minimize #maximize #compute #sum #count
    #min #max #avg #even #odd #mod #abs #true #infimum #program #include #forget #iinit t 0x1 :~ % %* *% not ` $"""
WORDS = [*PIECES.split(), "[1@2]", "[true]", "<1>", "<X,a>", "<2:1>"]
TEXTS = st.lists(st.sampled_from([*WORDS, "\n", ".\n", " "]), max_size=40).map(" ".join)


@given(st.one_of(TEXTS, st.text(max_size=80)))
def test_translate_raises_only_translation_errors(text):
    for undecided in (Dialect.GRINGO3, Dialect.CLINGO5):
        try:
            result = translate(text, "x.lp", undecided)
        except TranslationError as error:
            lines = [fault.line for fault in error.faults]
        else:
            lines = [1]
            assert translate(result.text, "x.lp", undecided).text == result.text
        assert lines
        assert all(1 <= line <= text.count("\n") + 1 for line in lines)


@given(st.text(max_size=200))
def test_tokens_cover_the_text_in_order(text):
    found = tokens(text)
    assert all(a.end <= b.start for a, b in zip(found, found[1:]))
    assert all(text[token.start : token.end] == token.text for token in found)


ATOMS = st.sampled_from(["a", "b", "c(1)", "c(2)", "-d"])
LITERALS = st.tuples(st.sampled_from(["", "not "]), ATOMS).map("".join)
CONDITIONS = st.lists(st.sampled_from(["x(X)", "not y(X)", "X < 3", "x(1;2)", "z(_)"]), max_size=3)
BODY_ITEMS = st.one_of(
    LITERALS,
    st.tuples(st.sampled_from(["p(X)", "not p(X)", "p(X;1)"]), CONDITIONS).map(
        lambda t: " : ".join([t[0], "x(X)", *t[1]])
    ),
    st.sampled_from(
        [
            "x(1;2)",
            "1 { a, b } 1",
            "1 == { a, b : x(1) }",
            "2 > { <1> : x(X) : a } >= 1",
            "2 [ a=2, b : x(_) = 1 ]",
            "Y := 1..2",
            "Y = #count { a, b }",
            "w(1..2)",
        ]
    ),
)
HEADS = st.one_of(
    ATOMS,
    st.sampled_from(
        [
            "",
            "{ a, b }",
            "1 { c(X) : x(X) : X != 2, a }",
            "a | b : x(1)",
            "c(1;2)",
            "e(1;2,x)",
            "1 [ a=1, b=2 ] 2",
            "[ a=1 ] < 2",
        ]
    ),
)
RULES = st.tuples(HEADS, st.lists(BODY_ITEMS, max_size=4)).map(
    lambda t: t[0] + (" :-\n  " + ", ".join(t[1]) if t[1] or not t[0] else "") + "."
)
FACTS = "x(1..2). y(2). z(1..2). w(1). { p(1..2) }.\n"
PROGRAMS = st.lists(RULES, min_size=1, max_size=4).map(lambda rules: FACTS + "\n".join(rules) + "\n#hide.\n")


@given(PROGRAMS)
def test_translations_are_valid_and_keep_their_lines(program):
    text = translated(program)
    solve(text)
    assert text.replace("% dialect: clingo 5\n", "").count("\n") == program.count("\n")
    assert translated(text) == text
    assert translate(text, "x.lp").text == text


@given(st.lists(RULES, min_size=1, max_size=3).map("\n".join))
def test_translate_leaves_random_common_rules_unchanged(program):
    text = translated(program + "\n#hide.").splitlines()
    if translate(program, "x.lp").dialect is Dialect.EITHER:
        assert text[: program.count("\n") + 1] == program.splitlines()


CHOICE = ("a", "b", "c(1)", "c(2)")
SUBSETS = [frozenset(s) for n in range(5) for s in itertools.combinations(CHOICE, n)]
WEIGHTED = st.lists(st.tuples(st.booleans(), st.sampled_from(CHOICE), st.integers(-3, 3)), max_size=5)
BOUNDS = st.tuples(st.none() | st.integers(-6, 6), st.none() | st.integers(-6, 6))
COMPARISONS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq}
PAIRS = [(one, "") for one in COMPARISONS] + [("", one) for one in COMPARISONS]
PAIRS += [(one, other) for same in (("<", "<="), (">", ">=")) for one in same for other in same]


def holds(negated, atom, true):
    return (atom in true) != negated


def between(value, bounds):
    lower, upper = bounds
    return (lower is None or lower <= value) and (upper is None or value <= upper)


def expected(meaning):
    """Return all subsets of a free choice, with `ok` if ``meaning`` holds."""
    return sorted(" ".join(sorted([*true, *(["ok"] if meaning(true) else [])])) for true in SUBSETS)


def bounded(text, bounds):
    return " ".join(
        [
            *([str(bounds[0])] if bounds[0] is not None else []),
            text,
            *([str(bounds[1])] if bounds[1] is not None else []),
        ]
    )


def shown(negated, atom):
    return ("not " if negated else "") + atom


@given(WEIGHTED, BOUNDS, st.booleans(), st.sampled_from(["", "#sum "]))
def test_translated_sums_count_every_element(elements, bounds, negate, name):
    inside = ", ".join(f"{shown(n, a)}={w}" for n, a, w in elements)
    program = "{{ a, b, c(1..2) }}. ok :- {}{}.".format(
        "not " if negate else "", bounded(name + "[ " + inside + " ]", bounds)
    )
    meant = expected(lambda true: between(sum(w for n, a, w in elements if holds(n, a, true)), bounds) != negate)
    assert answers(program) == meant


@given(WEIGHTED, BOUNDS, st.sampled_from(["", "#count "]))
def test_translated_sets_count_each_literal_once(elements, bounds, name):
    inside = ", ".join(shown(n, a) for n, a, _ in elements)
    program = "{{ a, b, c(1..2) }}. ok :- {}.".format(bounded(name + "{ " + inside + " }", bounds))
    meant = expected(lambda true: between(len({(n, a) for n, a, _ in elements if holds(n, a, true)}), bounds))
    assert answers(program) == meant


@given(WEIGHTED, st.sampled_from(PAIRS), st.integers(-6, 6), st.integers(-6, 6), st.booleans(), st.booleans())
def test_translated_aggregates_accept_comparisons_on_both_sides(elements, signs, left, right, negate, brackets):
    inside = ", ".join(shown(n, a) + (f"={w}" if brackets else "") for n, a, w in elements)
    before, after = (f"{left} {signs[0]}" if signs[0] else ""), (f"{signs[1]} {right}" if signs[1] else "")
    aggregate = f"[ {inside} ]" if brackets else f"{{ {inside} }}"
    program = "#base. {{ a, b, c(1..2) }}. ok :- {}{} {} {}.".format("not " if negate else "", before, aggregate, after)

    def meaning(true):
        value = sum(w for n, a, w in elements if holds(n, a, true))
        value = value if brackets else len({(n, a) for n, a, _ in elements if holds(n, a, true)})
        held = not signs[0] or COMPARISONS[signs[0]](left, value)
        return (held and (not signs[1] or COMPARISONS[signs[1]](value, right))) != negate

    assert solve(translated(program).replace("#base.", "")) == expected(meaning)


@given(WEIGHTED, BOUNDS)
def test_translated_averages_agree_with_the_model(elements, bounds):
    inside = ", ".join(f"{shown(n, a)}={w}" for n, a, w in elements)
    program = "{{ a, b, c(1..2) }}. ok :- {}.".format(bounded("#avg [ " + inside + " ]", bounds))

    def meaning(true):
        weights = [w for n, a, w in elements if holds(n, a, true)]
        return not weights or between(sum(weights) / len(weights), bounds)

    assert answers(program) == expected(meaning)


@given(WEIGHTED, st.sampled_from(["#even", "#odd"]), st.booleans())
def test_translated_parities_agree_with_the_model(elements, name, brackets):
    inside = ", ".join(shown(n, a) + (f"={w}" if brackets else "") for n, a, w in elements)
    program = "{{ a, b, c(1..2) }}. ok :- {} {}.".format(name, ("[ {} ]" if brackets else "{{ {} }}").format(inside))

    def meaning(true):
        value = sum(w for n, a, w in elements if holds(n, a, true))
        value = value if brackets else len({(n, a) for n, a, _ in elements if holds(n, a, true)})
        return value % 2 == (name == "#odd")

    assert answers(program) == expected(meaning)


@given(st.lists(st.sampled_from("123"), min_size=1, max_size=3), st.sets(st.sampled_from("123")), st.booleans())
def test_translated_body_pools_are_conjunctions(pool, facts, negated):
    program = "{} ok :- {}p({}). #hide. #show ok/0.".format(
        " ".join(f"p({f})." for f in sorted(facts)), "not " if negated else "", ";".join(pool)
    )
    meant = all((option in facts) != negated for option in pool)
    assert answers(program) == (["ok"] if meant else [""])
