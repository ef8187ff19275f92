"""Numerical methods on arrays, without any notion of contact."""
