"""Encounters: what lies or moves in the way of a leg and is on no map, and what the boat makes of it."""
