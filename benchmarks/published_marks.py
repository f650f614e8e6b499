"""How published numbers are drawn."""

from jointfmu_tools.studies.published.reference import ROLES

_MARKERS = {
    "calibration": {"marker": "o", "mfc": "white"},
    "circular": {"marker": "x"},
    "interpolation": {"marker": "D", "mfc": "white"},
    "prediction": {"marker": "o"},
}


def published_mark(role: str, colour: str = "black") -> dict[str, object]:
    """How a published number of a role is drawn, and its legend; filled points are predictions alone."""
    shape = _MARKERS.get(role, {"marker": "+"})
    return {"linestyle": "none", "color": colour, "ms": 5, "label": f"published, {ROLES[role]}"} | shape
