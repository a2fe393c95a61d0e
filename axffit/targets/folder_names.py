"""Names of files and folders made from ids that anybody may have written into a file."""

import hashlib
import re
from collections.abc import Iterable

_LONGEST = 80
_DIGITS = 10
# What Windows takes for devices, with any suffix.
_RESERVED = re.compile(r"(CON|PRN|AUX|NUL|CONIN\$|CONOUT\$|COM[0-9]|LPT[0-9])(\..*)?", re.IGNORECASE)
_SAFE = re.compile(r"[A-Za-z0-9_]([A-Za-z0-9_. -]*[A-Za-z0-9_-])?")


def safe_name(text: str) -> str:
    """A name for one file or folder on every platform: the text itself where it is one, else one made from it.

    Letters, digits, ``_ . -`` and blanks inside stay; everything else, path separators and NUL among it, becomes ``_``,
    at most 80 characters are kept, and ten digits of the text's SHA-256 are added so that different texts stay apart.
    The result never begins with a dot, never ends with a dot or blank, and is no name Windows reserves.
    """
    if len(text) <= _LONGEST and _SAFE.fullmatch(text) and not _RESERVED.fullmatch(text):
        return text
    kept = re.sub(r"[^A-Za-z0-9_. -]", "_", text)[: _LONGEST - _DIGITS - 1].strip(". -")
    # The underscore in front takes a reserved word its meaning.
    kept = f"_{kept}" if _RESERVED.fullmatch(kept) else kept
    return f"{kept or 'unnamed'}-{_digits(text)}"


def distinct_names(texts: Iterable[str]) -> dict[str, str]:
    """`safe_name` of each text, kept apart on file systems that do not heed case.

    The first of two that differ in case only keeps its name; the other gets digits of its SHA-256.
    """
    texts = list(dict.fromkeys(texts))
    names: dict[str, str] = {}
    taken: set[str] = set()
    # Texts that are names already go first, so that a made-up name never takes theirs.
    for text in sorted(texts, key=lambda text: safe_name(text) != text):
        name = safe_name(text)
        length = _DIGITS
        while name.casefold() in taken:
            name = f"{safe_name(text)[: _LONGEST - length - 1]}-{_digits(text, length)}"
            length += 1
        taken.add(name.casefold())
        names[text] = name
    return {text: names[text] for text in texts}


def _digits(text: str, count: int = _DIGITS) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:count]
