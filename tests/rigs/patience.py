"""How long a test waits for what happens in real time.

These bounds end a test that would otherwise hang. They measure nothing: a machine may carry many times its
load, and what is to be measured, `make bench` measures.
"""

MOMENT_S = 120.0  # for an answer, a thread, a program's end
JOB_S = 600.0  # for a program that starts, works and ends, or a client's whole session
