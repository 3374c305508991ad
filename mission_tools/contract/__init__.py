"""What goes with a route: its budget, its fence and rally points, and what is on board already."""
