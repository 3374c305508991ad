"""Reports for people: one self-contained HTML page of a run or of a campaign."""
