"""What is looked at before anything starts: the experiment with its files, and the machine."""
