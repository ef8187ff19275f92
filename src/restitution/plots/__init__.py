"""Figures, described as data and drawn by matplotlib or Plotly. Nothing is computed here."""
