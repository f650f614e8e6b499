"""What can be written, for the command line; loads nothing."""

FORMS = {
    "ansys": ("springs",),
    "calculix": ("springs", "contact"),
    "abaqus": ("springs", "contact"),
    "modelica": ("curve",),
    "csv": ("springs", "contact", "curve"),
}
"""{format: what it can hold}."""
ROBOTS = ("mjcf", "urdf")
"""Formats of robots, which hold a drive."""
WHAT = ("springs", "contact", "curve")
ERROR = 1e-3
"""Largest error of a table's load [1] by straight lines, unless another is asked for."""
