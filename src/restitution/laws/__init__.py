"""The restitution law of one pair: made from stored results, fitted, compared with closed forms."""
