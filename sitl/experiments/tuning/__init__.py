"""Finds a boat's PID gains by sailing it many times."""
