"""Print how many items of each crate are marked `pub`, and with `--list` their names."""

import argparse
import re
from pathlib import Path

CRATES = Path(__file__).parents[1] / "crates"
ITEM = re.compile(
    r"^ *pub (?:const |unsafe |async )*(fn|struct|enum|trait|type|const|static|mod) (\w+)", re.M
)
REEXPORTED = re.compile(r"^pub use ([^;]+);", re.M)


def items(path: Path) -> list[str]:
    """Return the public items of a file, without those of its tests, and what it exports again."""
    code = path.read_text(encoding="utf-8").split("#[cfg(test)]")[0]
    found = [f"{kind} {name}" for kind, name in ITEM.findall(code)]
    exported = REEXPORTED.findall(code) if path.name == "lib.rs" else []
    groups = (re.sub(r"^.*\{|\}", "", text, flags=re.S).split(",") for text in exported)
    return found + [f"use {name.strip()}" for group in groups for name in group if name.strip()]


def main() -> None:
    """Print a line for each crate."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--list", action="store_true", help="print the items, too")
    listed = parser.parse_args().list
    for crate in sorted(CRATES.glob("*/src")):
        found = [(path, item) for path in sorted(crate.rglob("*.rs")) for item in items(path)]
        print(f"{crate.parent.name:16} {len(found):5}")
        for path, item in found if listed else []:
            print(f"  {path.relative_to(crate)}: {item}")


if __name__ == "__main__":
    main()
