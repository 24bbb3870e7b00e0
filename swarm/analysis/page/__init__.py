"""The analysis as one file to hand round: a page whose numbers say where they come from."""
