"""Closed forms beside a case, a stored run or a law."""
