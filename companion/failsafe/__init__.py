"""Failsafes: what is watched, when it fires, and what the boat then does. `table.py` has it all."""
