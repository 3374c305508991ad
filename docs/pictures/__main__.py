"""Draw the pictures of the docs that no experiment draws, and write the notebook: python -m pictures.

`python -m pictures shore` makes only those of the shore page, which takes Chromium.
"""

import sys
from pathlib import Path

from pictures.encounter import draw_encounter
from pictures.notebook import write_notebook
from pictures.rollouts import draw_rollouts
from pictures.shore import draw_shore
from pictures.shore_parameters import draw_parameters
from pictures.shore_plan import draw_plan
from pictures.wiring import draw_wiring
from pictures.wiring_table import read_wiring

GUIDE = Path("docs/hardware.md")
WIRING = Path("docs/pictures/wiring.svg")
ROLLOUTS = Path("docs/pictures/rollouts.svg")
ENCOUNTER = Path("docs/pictures/encounter.svg")


def main() -> None:
    """Draw them all, or those of the page."""
    if sys.argv[1:] == ["shore"]:
        draw_shore()
        draw_plan()
        draw_parameters()
        return
    ROLLOUTS.write_text(draw_rollouts(), encoding="utf-8")
    ENCOUNTER.write_text(draw_encounter(), encoding="utf-8")
    WIRING.write_text(draw_wiring(read_wiring(GUIDE.read_text(encoding="utf-8"))), encoding="utf-8")
    write_notebook()


if __name__ == "__main__":
    main()
