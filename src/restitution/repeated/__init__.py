"""Impacts of the same two bodies, one after the other, on surfaces that keep what yielded."""
