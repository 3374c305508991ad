"""Watch the way ahead of a boat under way, and plan what is left of its mission anew where it is blocked."""
