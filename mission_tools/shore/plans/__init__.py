"""Plans: what the page asks for becomes a mission, by the planner in a process of its own."""
