"""Attraction of finite range: a traction at every node that depends on the gap."""
