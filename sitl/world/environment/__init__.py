"""What surrounds the hull: the water's own motion, wind and waves."""
