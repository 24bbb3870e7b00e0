"""Q-learning with imitation: equations 1-7 and algorithms 1-3 of the paper, each written once."""
