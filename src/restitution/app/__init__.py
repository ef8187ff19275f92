"""The page of `restitution app`: it redraws the curves of a case while a user changes values."""
