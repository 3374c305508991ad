"""Comparisons with peers; no timed tests. One file per question; `make bench` runs all."""
