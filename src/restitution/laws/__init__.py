"""The restitution law of one pair: from stored results, with fits and closed forms."""
