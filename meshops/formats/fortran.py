"""Real numbers as the solvers read and write them."""

from __future__ import annotations

import re

_EXPONENT_WITHOUT_E = re.compile(r"([+-]?[\d.]+)([+-]\d+)")


def real(text: str) -> float:
    """Value of a real field: '1.5', '.5', '1.5-3', '1.D+2'; a blank is 0.

    Raises ValueError where the text is no number.
    """
    if not text:
        return 0.0
    try:
        if "_" in text:
            raise ValueError(text)
        return float(text)
    except ValueError:
        pass
    plain = text.upper().replace("D", "E")
    short = _EXPONENT_WITHOUT_E.fullmatch(plain)
    if "_" in plain:
        raise ValueError(text)
    return float(f"{short[1]}E{short[2]}" if short else plain)


def canonical(text: str, *, zero: str = "0.0") -> str:
    """Make texts of one value equal; an integer stays one, and a zero becomes ``zero``."""
    if not text or text.isdecimal():
        return text
    try:
        value = real(text)
    except ValueError:
        return text.upper()
    return repr(value) if value else zero


def real_field(value: float, width: int = 16) -> str:
    """Write a number as exactly as ``width`` characters allow, in no more than it needs."""
    exact = _without_waste(repr(value))
    if len(exact) <= width:
        return exact
    for digits in range(16, 0, -1):
        candidates = {_without_waste(f"{value:.{digits}{how}}") for how in ("g", "e")}
        fitting = [text for text in candidates if len(text) <= width]
        if fitting:
            return min(fitting, key=lambda text: (abs(real(text) - value), text))
    raise ValueError(f"{value} does not fit into {width} characters")


def _without_waste(text: str) -> str:
    """'0.5e-05' as '.5-5': no leading or trailing zeros, no E, always a point."""
    mantissa, _, exponent = text.lower().partition("e")
    sign = "-" if mantissa.startswith("-") else ""
    whole, _, decimals = mantissa.lstrip("+-").partition(".")
    body = f"{whole.lstrip('0')}.{decimals.rstrip('0')}"
    if body == ".":
        return "0."
    return f"{sign}{body}{int(exponent):+d}" if exponent else f"{sign}{body}"
