"""Untranslatable text is refused with file, line and reason."""

import pytest

from rosoclingo.oclingo.errors import ProgramError
from rosoclingo.oclingo.gringo3 import Dialect, TranslationError, translate, translate_program


def faults(text):
    with pytest.raises(TranslationError) as caught:
        translate(text, "old.lp", Dialect.GRINGO3)
    return caught.value.faults


@pytest.mark.parametrize(
    ("text", "column", "words"),
    [
        ("#begin_lua f = 1 #end_lua.", 1, "scripts cannot be translated"),
        ("#hide. p(@f(1)).", 10, "calls of script functions"),
        ("#hide. p :- q", 13, "no dot at its end"),
        ("#hide. p :- 1.", 14, "expected a comparison, since the preceding term is not an atom"),
        ("#hide. p :- not X < 3 : a : b.", 19, "a comparison cannot be negated"),
        ("#hide. p :- X = #avg [ a ].", 17, "the value of #avg cannot be assigned"),
        ("#hide. p :- 1 #even { a }.", 15, "#even takes no bounds"),
        ("#hide. p :- { X < 3 : q(X) } 2.", 15, "a comparison as an element of a set"),
        ("#hide. 1 [ X < 3 : q(X) ].", 12, "a comparison in a head"),
        ("#hide. p :- 1;2 { a, b }.", 17, "a pool as bound"),
        ("#hide. #minimize [ a=1@1;2 ].", 20, "a pool as priority"),
        ("#hide. p :- 1 [ a=1..2 ].", 17, "an interval as weight or priority"),
        ("#minimize [ X < 2 ].", 13, "unexpected comparison"),
        ("#hide. #minimize a.", 18, "'{' or '['"),
        ("#hide. #foo bar.", 8, "gringo 3 has no directive '#foo'"),
        ("#hide p/X.", 9, "unexpected 'X', expected a number"),
        ("#domain p(X,1).", 9, "#domain takes an atom whose arguments are variables"),
        ("#domain f(X). p :- q(X); r.", 15, "a variable that #domain declares"),
        ("p(n). #const n = 1. #hide.", 7, "gringo 3 does not replace 'n' in the statements before"),
        ("#hide. #show p(X) : q(X). #cumulative t. p(t).", 8, "the base part cannot show"),
        ("#hide. #show p/1. #hide p(1).", 19, "or in one that hides all"),
        ("#hide. const n = 1.", 14, "unexpected"),
        ("#hide. p :- 1 <= [ a ] > 1.", 24, "these bounds do not fit together"),
        ("#hide. p :- 1 < #avg [ a=2 ].", 17, "next to an average cannot be translated"),
        ("#hide. p :- #sum { <1> : a, b } 1.", 29, "#sum { .. } takes tuples"),
        ("#hide. p :- { <1> } 1.", 19, "unexpected '}', expected ':'"),
        ("#compute { <1> : a }.", 12, "#compute takes no tuples"),
        ("#hide. #const n = 1..3.", 8, "a #const with a pool or a range cannot be translated"),
        ("#hide. #const n = f(X).", 8, "the value of a constant cannot contain a variable"),
        ("#hide. p(`).", 10, "unexpected '`'"),
        ("#hide. p :- q. %* open", 16, "no dot at its end"),
        ("#hide. p :- not 1 #avg [ a=2 ] 2.", 13, "'not' before an average with two bounds"),
        ("#hide. #include x.", 17, "a file name in quotes"),
        ("#hide p(1). #cumulative t. p(t).", 1, "single atoms cannot be hidden in a program with steps"),
        ("#hide. p :- #even { <1> : a }.", 21, "#even takes no tuples"),
        ("#hide. p :- #count [ a=2 ] 1.", 22, "#count takes no weights"),
        ("#hide. #minimize { <> : a }.", 20, "needs a weight"),
        ("#hide. :~ a. <1..2>", 12, "a pool or an interval as weight of a weak constraint"),
    ],
)  # fmt: skip
def test_translate_reports_line_and_reason_of_faults(text, column, words):
    (fault,) = faults(text)
    assert (fault.file, fault.line, fault.column) == ("old.lp", 1, column)
    assert words in fault.message


def test_translate_suggests_a_fix_for_faults():
    assert faults("#hide. minimize [ a ].")[0].remedy == "write '#minimize' for the directive"
    assert faults("p(n).\n#const n = 1. #hide.")[0].remedy == "put the #const before its use in old.lp:1"


@pytest.mark.parametrize("text", ["p({}).".format("f(" * 200 + "1" + ")" * 200), "p({}1).".format("-" * 300)])
def test_translate_refuses_too_deeply_nested_terms(text):
    assert len(faults(text + " #hide.")) == 1


def test_translate_refuses_pools_with_too_many_literals():
    pool = "1;2;3;4;5;6;7;8;9;10"
    (fault,) = faults(":- p({}).".format(", ".join([pool] * 6)))
    assert "more than 10000 literals" in fault.message


@pytest.mark.slow
def test_long_sums_and_pools_are_not_nested():
    text = "p({}) :- q({}).".format("+".join(["1"] * 2000), ";".join(map(str, range(2000))))
    assert translate(text, "x.lp", Dialect.GRINGO3).text.count("q(") == 2000


def test_translate_program_lists_faults_of_all_files():
    files = [("a.lp", "#hide.\np :- @f(1) == X.\n:- [ b=1;2 ] 3, q.\n"), ("b.lp", "{ a, b }.\n\n  #foo.\n")]
    with pytest.raises(ProgramError) as caught:
        translate_program(files)
    assert [(fault.file, fault.line) for fault in caught.value.faults] == [("a.lp", 2), ("a.lp", 3), ("b.lp", 3)]
    assert str(caught.value).splitlines()[2].startswith("b.lp:3:3: gringo 3 has no directive '#foo'")


def test_translate_warns_about_domain_after_its_use():
    result = translate("p(F) :- q(F).\n#domain f(F).", "x.lp")
    assert result.warnings == ("x.lp:2:1: #domain does not apply to earlier statements that use F",)
