"""Restitution laws: COR of one pair against impact velocity, with fits and closed forms."""
