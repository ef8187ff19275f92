"""Restitution laws: coefficient of restitution (COR) of two bodies against impact velocity."""
