"""Properties of the translation of any text, and answers of random programs against a model of gringo 3."""

import itertools
import operator

from gringo3_answers import answers, solve, translated
from hypothesis import given, settings
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
ELEMENTS = st.lists(st.tuples(st.booleans(), st.sampled_from(CHOICE), st.integers(-3, 3)), max_size=5)
COMPARISONS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq}
PAIRS = [(one, "") for one in COMPARISONS] + [("", one) for one in COMPARISONS]
PAIRS += [(one, other) for same in (("<", "<="), (">", ">=")) for one in same for other in same]
LOOSE = [pair for pair in PAIRS if not {"<", ">"} & {*pair}]
NUMBERS = st.integers(-6, 6)
#: What stands before and after an aggregate: the sign of a comparison and a number, or a bound; each can be absent.
BOUNDS = st.tuples(st.none() | NUMBERS.map(lambda one: ("", one)), st.none() | NUMBERS.map(lambda one: ("", one)))


def signs(pairs):
    """Generate comparisons before and after an aggregate with these signs."""
    found = st.tuples(st.sampled_from(pairs), NUMBERS, NUMBERS)
    return found.map(lambda one: tuple(sign and (sign, number) for sign, number in zip(one[0], one[1:])))


AGGREGATES = st.one_of(
    st.tuples(st.sampled_from(["[", "#sum [", "{", "#count {"]), BOUNDS | signs(PAIRS), st.booleans()),
    st.tuples(st.just("#avg ["), BOUNDS | signs(LOOSE), st.just(False)),
    st.tuples(st.sampled_from(["#even [", "#even {", "#odd [", "#odd {"]), st.just((None, None)), st.just(False)),
)


def value_of(name, elements, true):
    """Return the value of an aggregate if these atoms are true: each element counts, and each literal once in braces.

    None is the average of nothing.
    """
    weights = [weight for negated, atom, weight in elements if (atom in true) != negated]
    if name.endswith("{"):
        weights = [1] * len({(negated, atom) for negated, atom, _ in elements if (atom in true) != negated})
    if "#avg" in name:
        return sum(weights) / len(weights) if weights else None
    return sum(weights)


def meaning(name, elements, guards, true):
    """Return whether an aggregate with these guards holds."""
    value, (before, after) = value_of(name, elements, true), guards
    if "#even" in name or "#odd" in name:
        return value % 2 == ("#odd" in name)
    if value is None:
        return True
    held = not before or COMPARISONS[before[0] or "<="](before[1], value)
    return held and (not after or COMPARISONS[after[0] or "<="](value, after[1]))


@settings(max_examples=settings.default.max_examples * 4)
@given(ELEMENTS, AGGREGATES)
def test_translated_aggregates_agree_with_the_model(elements, aggregate):
    name, (before, after), negate = aggregate
    weighted = name.endswith("[")
    inside = ", ".join(("not " if n else "") + a + (f"={w}" if weighted else "") for n, a, w in elements)
    left = "{1} {0}".format(*before) if before else ""
    right = "{} {}".format(*after) if after else ""
    text = f"{left} {name} {inside} {']' if weighted else '}'} {right}"
    program = "#base. {{ a, b, c(1..2) }}. ok :- {}{}.".format("not " if negate else "", text)
    holding = [meaning(name, elements, (before, after), true) != negate for true in SUBSETS]
    expected = sorted(" ".join(sorted([*true, *["ok"] * held])) for true, held in zip(SUBSETS, holding))
    assert solve(translated(program).replace("#base.", "")) == expected


@given(st.lists(st.sampled_from("123"), min_size=1, max_size=3), st.sets(st.sampled_from("123")), st.booleans())
def test_translated_body_pools_are_conjunctions(pool, facts, negated):
    program = "{} ok :- {}p({}). #hide. #show ok/0.".format(
        " ".join(f"p({f})." for f in sorted(facts)), "not " if negated else "", ";".join(pool)
    )
    meant = all((option in facts) != negated for option in pool)
    assert answers(program) == (["ok"] if meant else [""])
