"""The restitution law of one pair: from stored results to fits, and beside the closed forms."""
