"""How far a contact can be trusted: findings on its input, its grid and its results."""
