"""Formatting of names and numbers."""

from __future__ import annotations


def video_name(scene: str, method: str) -> str:
    """Return the name of a video: the scene, and the method if it is not the default."""
    method = method.replace("article-", "2015-")  # the year of the article and its two programs
    return scene if method == "quadtree" else f"{scene}-{method}"


def pairs_of(n: int) -> int:
    """Return n(n-1)/2, the tests of plain brute force."""
    return n * (n - 1) // 2


def scientific(value: float) -> str:
    """Return four digits, and a power of ten if the number is large."""
    value += 0.0  # no negative zero
    mantissa, _, power = f"{value:.3e}".partition("e")
    return f"{value:,.1f}" if abs(value) < 1e5 else f"{mantissa} e{int(power)}"


def share(part: int, whole: int) -> str:
    """Return a ratio in per cent, with two significant digits."""
    if whole == 0:
        return "–"
    return f"{100 * part / whole:.2g} %" if part < whole else f"{100 * part / whole:,.0f} %"
