"""What a route costs besides its length: time or charge in a current, slow zones, nearness to the shore."""
