"""From claims and results to verdicts: one file for each kind of comparison."""
