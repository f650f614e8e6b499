"""Mechanics between interface law and joint: tabulated curves, friction with history, contact pressure."""
