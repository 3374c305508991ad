"""`boat-sitl serve` that writes down the CPU time of every tick.

python -m benchmarks.timed_fleet FILE serve …
"""

import importlib
import json
import sys
import time
from pathlib import Path

from sitl.__main__ import main
from sitl.run.serve import Server

_ticks_s: list[float] = []


class _TimedServer(Server):
    def _step(self, number: int) -> None:
        began_s = time.thread_time()
        super()._step(number)
        _ticks_s.append(time.thread_time() - began_s)


if __name__ == "__main__":
    path = Path(sys.argv.pop(1))
    vars(importlib.import_module("sitl.cli.serve"))["Server"] = _TimedServer
    try:
        main()
    finally:
        path.write_text(json.dumps(_ticks_s))
