"""The command `jostle tune`: a progress bar, a small table, and the picture."""

from pathlib import Path

from rich import box
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from .measure import ARTICLE, Map, measure
from .picture import draw, in_ms


def tune(scene: str, n: int, out: Path, console: Console) -> None:
    """Measure a scene, print a table, and save the picture."""
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task(f"{scene}, {n:,} particles", total=1.0)
        found = measure(scene, n, report=lambda share: bar.update(task, completed=share))
    console.print(table(found), highlight=False)
    draw([found], out)
    console.print(f"picture  {out}", highlight=False, soft_wrap=True)


def table(found: Map) -> Table:
    """Return the times of the fastest, default and slowest setting, and of the article's."""
    shown = Table(title=f"{found.scene}, {found.n:,} particles", box=box.SIMPLE_HEAD)
    shown.add_column("")
    for name in ("leaf capacity", "depth", "ms", "relative"):
        shown.add_column(name, justify="right", no_wrap=True)
    slowest = max(found.rounds, key=found.seconds)
    settings = found.best, found.default, ARTICLE, slowest
    names = "fastest", "default", "article of 2015", "slowest"
    for name, (capacity, depth) in zip(names, settings, strict=True):
        same = found.same_tree(capacity, depth)
        timed = same in found.rounds
        times = [in_ms(found.seconds(same)), f"{found.over_best(same):.2f}"]
        limit = "no limit" if depth == found.default.max_depth else f"{depth}"
        shown.add_row(name, f"{capacity}", limit, *(times if timed else ["too slow", ""]))
    return shown
