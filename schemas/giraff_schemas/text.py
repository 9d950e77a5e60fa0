"""Text that others have written: made fit for a terminal and a log, and in our words. The only place that does so.

And the only one that tells which word was meant where one is mistyped.
"""

import re
from collections.abc import Callable, Iterable
from typing import Final

_Rows = tuple[tuple[str, str | Callable[[re.Match[str]], str]], ...]

_TYPES: Final = {
    "float": "a number",
    "int": "a whole number",
    "str": "text",
    "bool": "true or false",
    "array": "a list",
    "object": "a table of fields",
    "null": "none",
    "datetime": "a date with its time",
}
"""Our words by those of msgspec."""
_BOUNDS: Final = {"<=": "at most", ">=": "at least", "<": "below", ">": "above"}
_PLACE: Final = re.compile(r" - at `(?:key` in `)?\$\.?(.*)`$")
_VALUES: Final[_Rows] = (
    (r"Expected `(?:int|float)` ([<>]=?) (\S+)", lambda m: f"must be {_BOUNDS[m[1]]} {m[2]}"),
    (r"Expected `array` of length (\d+), got (\d+)", r"must have \1 values, and has \2"),
    (r"Expected `(\w+)` of (?:at most )?length (?:<= )?(\d+)(?:, got \d+)?", r"is longer than \2"),
    (r"Expected `datetime` with a timezone.*", "needs a time zone"),
    (r"Expected `int`, got `float`", "must be a whole number"),
    (r"Expected `([^`]+)`, got `(\w+)`", lambda m: f"must be {_kinds(m[1])}, and is {_kinds(m[2], 'a number')}"),
    (r"Expected `([^`]+)`.*", lambda m: f"must be {_kinds(m[1])} of another form"),
    (r"Invalid (?:enum )?value ('.*'|-?\d+)", r"cannot be \1"),
    (r"(?:Number|Integer value) out of range", "is a number that no message can hold"),
    (r"Invalid (?:RFC3339|base64|UUID|epoch).*", "is written wrongly"),
)
"""Our words for texts of msgspec about a value whose place it names."""
_FIELDS: Final[_Rows] = (
    (r"Object missing required field `(.*)`", r"`\1` is missing"),
    (r"Object contains unknown field `(.*)`", r"unknown field `\1`"),
)
"""Our words for texts of msgspec about a table of fields."""
_TEXTS: Final[_Rows] = (
    (r"Input data was truncated", "it ends too early"),
    (r".* is malformed: .*\(byte (\d+)\)", lambda m: f"it is wrong from character {int(m[1]) + 1} on"),
    (r"'utf-8' codec can't decode .* in position (\d+).*", r"it is no text at byte \1"),
    (r"'utf-8' codec can't encode .*", "it is no text"),
    (r"maximum recursion depth exceeded.*", "it is nested too deeply"),
    (
        r"(?:Exceeds the limit|int too large|Python int too large|can't serialize ints).*",
        "it has a number that no message can hold",
    ),
    (r"invalid literal for int\(\) with base \d+: (.*)", r"\1 is no whole number"),
    (r"could not convert string to float: (.*)", r"\1 is no number"),
    (r"(.*'.*') is not a valid float(?: range)?\.?", r"\1 is no number"),
    (r"(.*'.*') is not a valid int(?:eger)?(?: range)?\.?", r"\1 is no whole number"),
    (r"(.*) is not in the range x>=(.*?)\.?", r"\1 must be \2 or more"),
    (r"(.*) is not in the range (.*)<=x<=(.*?)\.?", r"\1 must be between \2 and \3"),
)
"""Our words for texts of libraries about a whole text."""
_TOML_AT: Final = re.compile(r"(.*) \(at (line \d+, column \d+|end of document)\)")
_TOML: Final[_Rows] = (
    (r"Invalid value", "a value is missing, or is text without quotes"),
    (r"Expected newline or end of document.*", "something stands behind an entry: one a line"),
    (r"(?:Cannot overwrite a value|Duplicate inline table key.*)", "a name stands there twice"),
    (r"Cannot declare \(?'(.*?)'.*\)? twice", r"the table [\1] stands there twice"),
    (r"Unterminated string|Expected.*['\"]{1,3}.*string.*", "a quote is missing"),
    (r"Expected '(.)'.*", r"\1 is missing"),
    (r"Unclosed (?:array|inline table)", "a closing bracket is missing"),
    (r".*", "an entry is to be NAME = VALUE"),
)


def printable(text: str) -> str:
    """Return the text on one line, with "?" for each character that could steer a terminal or hide other text."""
    return "".join(character if character.isprintable() else "?" for character in text)


MOST_KEPT: Final = 200
"""Characters of a text of others, such as who asks and why."""


def brief(text: str, most: int = MOST_KEPT) -> str:
    """Return a text of others as it may be stored, published, logged and shown: short, and on one line."""
    return printable(text[:most])


def printable_lines(text: str) -> str:
    """Clean each line like `printable`, and keep the ends of the lines."""
    return "\n".join(map(printable, text.split("\n")))


def plain(error: Exception | str) -> str:
    """Return in our words, on one line, what a library says of a value or a text that it cannot read.

    A text that is ours already stays as it is, behind the place that the library has added to it.
    """
    said = " ".join(str(error).split())
    if (mark := getattr(error, "problem_mark", None)) is not None:  # of YAML
        return f"line {mark.line + 1}, column {mark.column + 1}: it cannot be read"
    if toml := _TOML_AT.fullmatch(said):
        return f"{toml[2].replace('end of document', 'at the end')}: {_by(_TOML, toml[1])}"
    found = _PLACE.search(said)
    what = said[: found.start()] if found else said
    place = re.sub(r"\[(\d+)\]", lambda index: f" {int(index[1]) + 1}", _keyed(found[1])) if found else ""
    if value := _by(_VALUES, what):
        return f"{place or 'it'} {value}"
    if field := _by(_FIELDS, what):
        return f"{field} in {place}" if place else field
    ours = _by(_TEXTS, what) or what
    return f"{place}: {ours}" if place else ours


_CLEARLY: Final = 0.1
"""Share of letters in common by which the nearest word leaves the next one out of a question."""


def near(word: str, known: Iterable[str], most: int = 1, cutoff: float = 0.6) -> list[str]:
    """Return the known words that may be meant, the nearest first. `cutoff`: least share of letters in common."""
    import difflib  # noqa: PLC0415  for what is mistyped, which is seldom

    return difflib.get_close_matches(word, [*known], n=most, cutoff=cutoff)


def meant(word: str, known: Iterable[str], cutoff: float = 0.6) -> str:
    """Return a question for the known words that are near, with a blank behind it; empty: none is."""
    import difflib  # noqa: PLC0415  as above

    found = near(word, known, 2, cutoff)
    shares = [difflib.SequenceMatcher(None, each, word).ratio() for each in found]
    if shares and shares[0] - shares[-1] > _CLEARLY:
        del found[1:]
    return f"did you mean {' or '.join(found)}? " if found else ""


def _by(rows: _Rows, said: str) -> str:
    """Return what the first row that fits makes of it; empty: none fits."""
    matches = ((re.fullmatch(pattern, said), words) for pattern, words in rows)
    return next((words(m) if callable(words) else m.expand(words) for m, words in matches if m), "")


def _keyed(place: str) -> str:
    """Without msgspec's word for a name or a number that it does not tell."""
    return place.replace("[...]", "").replace("].", "], ")


def _kinds(types: str, whole: str = _TYPES["int"]) -> str:
    """Return `a number or none` of `float | null`. `whole`: the word for an int."""
    return " or ".join((_TYPES | {"int": whole}).get(each, each) for each in types.split(" | "))
