"""Damage to files: what a slipped hand, a broken disk or another program makes of them."""

from __future__ import annotations

import re
from collections.abc import Callable
from random import Random

TIMES = (1, 1, 1, 2, 3)
"""How often an input is damaged; one that is damaged once is read more often than not."""

WORDS = (
    b"", b"0", b"-1", b"1", b"nan", b"inf", b"-1e308", b"1e308", b"1e-400", b"99999999999999999999",
    b"2147483648", b"1.5", b"THRU", b"ALL", b"*", b"+", b"=", b"'", b'"', b"(", b"<", b"#", b"\\",
    b"\x00", b"\xff\xfe", b"\xef\xbb\xbf", b"\xb2", b"$End", b"include", b"true", b"[]", b"{}",
)  # fmt: skip
"""What stands in the place of a word, or between two."""

_WORD = re.compile(rb"[^\s,=<>\"']+")
_NUMBER = re.compile(rb"[-+]?\d*\.?\d+")

Mutation = Callable[[bytes, Random], bytes]


def mutated(data: bytes, random: Random) -> bytes:
    """Damage data in one to three ways."""
    for _ in range(random.choice(TIMES)):
        data = random.choice(MUTATIONS)(data, random)
    return data


def flip_bytes(data: bytes, random: Random) -> bytes:
    """Put other bytes in the place of a few."""
    found = bytearray(data)
    for _ in range(min(len(found), random.randint(1, 8))):
        found[random.randrange(len(found))] = random.randrange(256)
    return bytes(found)


def cut_short(data: bytes, random: Random) -> bytes:
    """Leave out the end."""
    return data[: random.randint(0, len(data))]


def leave_out(data: bytes, random: Random) -> bytes:
    """Leave out a piece of a few bytes."""
    at = random.randint(0, len(data))
    return data[:at] + data[at + random.randint(1, 64) :]


def insert(data: bytes, random: Random) -> bytes:
    """Put random bytes or a word somewhere."""
    at = random.randint(0, len(data))
    new = random.choice(WORDS) if random.random() < 0.5 else random.randbytes(random.randint(1, 16))
    return data[:at] + new + data[at:]


def copy_piece(data: bytes, random: Random) -> bytes:
    """Put a piece of the data somewhere else."""
    start, at = random.randint(0, len(data)), random.randint(0, len(data))
    return data[:at] + data[start : start + random.randint(1, 200)] + data[at:]


def drop_lines(data: bytes, random: Random) -> bytes:
    """Leave out a line or a few that follow each other."""
    lines = data.splitlines(keepends=True)
    at = random.randrange(len(lines) or 1)
    return b"".join(lines[:at] + lines[at + random.randint(1, 4) :])


def repeat_line(data: bytes, random: Random) -> bytes:
    """Write a line twice, or many times."""
    lines = data.splitlines(keepends=True)
    at = random.randrange(len(lines) or 1)
    return b"".join(lines[:at] + lines[at : at + 1] * random.choice((2, 2, 50)) + lines[at + 1 :])


def swap_lines(data: bytes, random: Random) -> bytes:
    """Exchange two lines."""
    lines = data.splitlines(keepends=True)
    if len(lines) > 1:
        a, b = random.randrange(len(lines)), random.randrange(len(lines))
        lines[a], lines[b] = lines[b], lines[a]
    return b"".join(lines)


def change_word(data: bytes, random: Random) -> bytes:
    """Put another word in the place of one, or one of the data itself."""
    found = list(_WORD.finditer(data))
    if not found:
        return data
    here = random.choice(found)
    new = random.choice(WORDS) if random.random() < 0.7 else random.choice(found).group()
    return data[: here.start()] + new + data[here.end() :]


def change_number(data: bytes, random: Random) -> bytes:
    """Make a number huge, tiny, negative or none."""
    found = list(_NUMBER.finditer(data))
    if not found:
        return data
    here = random.choice(found)
    text = here.group()
    new = random.choice(
        (text + b"00000000", b"-" + text, text + b"e300", text + b"e-320", b"nan", b"1" + text)
    )
    return data[: here.start()] + new + data[here.end() :]


MUTATIONS: tuple[Mutation, ...] = (
    flip_bytes,
    cut_short,
    leave_out,
    insert,
    copy_piece,
    drop_lines,
    repeat_line,
    swap_lines,
    change_word,
    change_word,
    change_number,
    change_number,
)
"""All ways; words and numbers twice as often."""
