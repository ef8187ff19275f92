"""Adhesion of zero range (the JKR limit): nodes attach, carry tension and are released."""
