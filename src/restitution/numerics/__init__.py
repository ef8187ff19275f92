"""Numerical methods on arrays; nothing here is specific to contact mechanics."""
