"""Checks of a contact: findings about its input, its grid and its results."""
