"""Names made from ids that anybody may have written into a file."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axffit.targets.folder_names import distinct_names, safe_name

NASTY = [
    "",
    ".",
    "..",
    "../evil",
    "../../../../etc/passwd",
    "/etc/passwd",
    "C:\\Windows\\evil",
    "\\\\server\\share",
    "a/b",
    "a\0b",
    "con",
    "NUL",
    "LPT1.txt",
    "COM0",
    "CONOUT$",
    "name.",
    "name ",
    " name",
    "-rf",
    ".hidden",
    ".axffit-x.tmp",
    "a:b",
    "tab\there",
    "new\nline",
    "x" * 300,
    "ü" * 90,
    "\ud800",
    "a?*<>|\"'`$;",
    "~",
]
RESERVED = re.compile(r"(con|prn|aux|nul|conin\$|conout\$|com\d|lpt\d)(\..*)?", re.IGNORECASE)


def is_safe(name):
    return (
        1 <= len(name) <= 80
        and re.fullmatch(r"[A-Za-z0-9_. -]+", name)
        and name[0] not in ".- "
        and name[-1] not in ". "
        and not RESERVED.fullmatch(name)
    )


@pytest.mark.parametrize(
    "name", ["paint", "_SVBRDF_NormalMap", "Volkswagen LY9B", "a-1.b", "X" * 80, "console", "COM10"]
)
def test_a_name_that_is_one_stays(name):
    assert safe_name(name) == name


@pytest.mark.parametrize("text", NASTY, ids=ascii)
def test_a_text_that_is_no_name_becomes_one(text):
    assert is_safe(safe_name(text))
    assert safe_name(text) != text


def test_different_texts_stay_apart():
    assert len({safe_name(text).casefold() for text in NASTY}) == len(NASTY)


@given(st.lists(st.text(max_size=90) | st.sampled_from(NASTY) | st.text("aA.", max_size=3), max_size=12))
def test_names_are_safe_distinct_and_kept_in_order(texts):
    names = distinct_names(texts)
    assert list(names) == list(dict.fromkeys(texts))
    assert all(is_safe(name) for name in names.values())
    assert len({name.casefold() for name in names.values()}) == len(names)
    assert names == distinct_names(texts)


def test_texts_that_differ_in_case_only():
    names = distinct_names(["Paint", "paint", "PAINT"])
    assert names["Paint"] == "Paint"
    assert re.fullmatch(r"paint-[0-9a-f]{10}", names["paint"])
    assert re.fullmatch(r"PAINT-[0-9a-f]{10}", names["PAINT"])


def test_a_made_up_name_takes_no_other_text_s_name():
    made = safe_name("../a")
    names = distinct_names(["../a", made])
    assert names[made] == made
    assert names["../a"].casefold() != made.casefold()
