"""Case file to stored results."""
