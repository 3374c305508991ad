"""Campaigns: many runs from one file, over all cores, kept as they come, judged at the end."""
