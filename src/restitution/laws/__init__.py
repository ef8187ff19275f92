"""Restitution laws: coefficient of restitution (COR) of two bodies against impact velocity.

The package also contains fits to a computed law, and closed forms for smooth bodies.
"""
