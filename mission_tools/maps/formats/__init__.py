"""Readers of map formats besides GeoJSON, each imported when a file needs it."""
