"""`boat-sitl serve` whose status counts the ticks that begin more than 10 ms late, not 5.

python -m benchmarks.late_boat serve …
"""

import importlib

from sitl.__main__ import main

if __name__ == "__main__":
    vars(importlib.import_module("companion.app.runner"))["LATE_S"] = 0.010
    main()
