"""Aerial photographs turned into maps of the water."""
