"""The text of translations, with unchanged parts and line numbers."""

import pytest
from gringo3_answers import translated

from rosoclingo.oclingo.gringo3 import Dialect, translate, translate_program


@pytest.mark.parametrize(
    ("old", "new"),
    [
        # conditions and separators, with their layout
        ("1 { m(B,L,t) : b(B) : l(L) : B!=L } 1 :- not g(t).", "1 { m(B,L,t) : b(B), l(L), B!=L } 1 :- not g(t)."),
        ("on(B) :- not m(B,L) : l(L) : L > 1 , b(B) , c.", "on(B) :- not m(B,L) : l(L), L > 1; b(B) , c."),
        # tokens: escaped quotes, nested comments, names with quotes, ends of lines
        ('{ p("a\\"%, b"), q } :- % c, d\n %* x, y %* z *% *% f(X\'_1, _).',
         '{ p("a\\"%, b"); q } :- % c, d\n %* x, y %* z *% *% f(X\'_1, _).'),
        ("{ a, b }.\r\np :- q(1;2),\r\n r.\r", "{ a; b }.\r\np :- q(1), q(2),\r\n r.\r"),
        # directives
        ("#external p(X,t) : d(X) : 0 < t+1 : e(X;X).", "#external p(X,t) : d(X), 0 < t+1, e(X), e(X)."),
    ],
)  # fmt: skip
def test_translate_produces_the_expected_text(old, new):
    assert translated(old + "\n").replace("\n% dialect: clingo 5", "") == new + "\n"


@pytest.mark.parametrize("text", ["", "\n", "% only a comment", "p", "p.%", "\r\np.\r\n"])
def test_translate_leaves_tiny_texts_unchanged(text):
    assert translate(text, "x.lp").text == text


def test_translated_minimize_in_steps_counts_each_step():
    result = translate("#cumulative k. #minimize [ a(k) : b ].", "dir/x.lp", Dialect.GRINGO3)
    assert '#minimize { 1@0,"x.lp:1",k,0 : a(k), b }.' in result.text
    result = translate("#program step(k).\n#minimize [ a(k) : b ].", "x.lp", Dialect.GRINGO3)
    assert '#minimize { 1@0,"x.lp:1",k,0 : a(k), b }.' in result.text


A, B = "p. q(1).\n#hide p/0.\n#hide r/1.", "r(1). #external e/2. s :- t. { u : v } . #hide x/0."
CLINGO5 = "q(X;1) :- r(X); s. -t. { u; v : w }. #external x(1). y : z ; w. :- a; b. f(1..2,2;3)  :- b; c."


@pytest.mark.parametrize(
    ("files", "shown"),
    [
        ((A, B), "#show. #show q/1. #show e/2. #show s/0. #show u/0."),
        (
            ("#hide p/0.", CLINGO5),
            "#show. #show q/1. #show -t/0. #show u/0. #show v/0. #show x/1. #show y/0. #show w/0. #show f/2. "
            "#show f/1.",
        ),
    ],
)
def test_show_directives_of_all_heads_replace_the_first_hide(files, shown):
    texts = [result.text for result in translate_program([("a.lp", files[0]), ("b.lp", files[1])])]
    assert texts[0].endswith(shown + "\n% dialect: clingo 5\n")
    assert "#hide" not in texts[1]
    assert texts[1].startswith(files[1].replace("#hide x/0.", ""))
