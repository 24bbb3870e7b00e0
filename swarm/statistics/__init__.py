"""Statistics over replicates: intervals, paired tests, effect sizes, times to a threshold."""
