"""Find parameters of a case from measured coefficients of restitution."""
