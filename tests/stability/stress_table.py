"""The table of numerical stress as JSON and as a page.

`python stress_table.py docs/stability.md` writes the page from the full form, and the JSON beside it."""

import argparse
import tempfile
from pathlib import Path

from kept_table import write
from stress_judge import Judge, rows

FULL_SEEDS, FULL_SPP_FACTOR = 4, 4

HEAD = """# Numerical stress

Scenes at the limits of numbers, by all methods: each picture is right, or the scene is refused with a reason, or a
warning names what is wrong. Written by `python tests/stability/stress_table.py docs/stability.md`; `stability.json`
beside it has the same rows, `make stability` judges them anew, and `make test` does with fewer samples.

Expected is the mean over the picture: a closed form, or the mean of the same scene without the stress, by the same
method with the same seeds. Measured are the means of 4 seeds, with the difference from what was expected. Dark boxes
stand in light of 1000: of some million reflections one slips through an edge, where walls meet within the rounding
of their places. Scenes are in `tests/stability/stress_scenes.py`, cases and tolerances in `stress_cases.py`.

| case | method | expected | measured | tolerance | verdict |
|---|---|---|---|---|---|
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("markdown", type=Path)
    target: Path = parser.parse_args().markdown
    with tempfile.TemporaryDirectory() as folder:
        write(HEAD, rows(Judge(Path(folder), FULL_SEEDS, FULL_SPP_FACTOR)), target)


if __name__ == "__main__":
    main()
