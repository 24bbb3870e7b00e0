"""One file a study of the paper, and the paper's claims as data."""
