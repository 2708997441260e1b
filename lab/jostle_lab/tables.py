"""Printing of tables without truncated figures."""

from __future__ import annotations

from rich.console import Console
from rich.measure import Measurement
from rich.table import Table

MOST_COLUMNS = 1_000  # of characters, which no table needs


def print_whole(table: Table, console: Console) -> None:
    """Print a table as wide as its figures, whatever the width of the console."""
    wide = console.options.update(width=MOST_COLUMNS)
    title, caption, table.title, table.caption = table.title, table.caption, None, None
    if title:
        console.print(title, style="bold", highlight=False)
    table.width = Measurement.get(console, wide, table).maximum
    console.print(table, highlight=False, crop=False)
    if caption:
        console.print(caption, style="dim", highlight=False)
