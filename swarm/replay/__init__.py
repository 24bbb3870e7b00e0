"""The time machine: a log's observations through the learner once more, as they were or with a change."""
