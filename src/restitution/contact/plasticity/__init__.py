"""How bodies yield: a bound of the contact pressure."""
