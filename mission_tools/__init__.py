"""The planner process: map, A* path, waypoints, upload, read-back, follow."""
