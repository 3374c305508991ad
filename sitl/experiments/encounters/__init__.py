"""The avoidance experiment: unmapped obstacles and movers on a leg."""
