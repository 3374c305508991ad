"""Benchmarks of route planning."""
