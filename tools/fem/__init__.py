"""Finite elements: the contact of two bolted bodies and the modes of the assembly."""


def missing(what: str, error: Exception) -> ValueError:
    """The refusal where a package, or a system library of gmsh, is missing for what they should do."""
    return ValueError(
        f"{what} needs what is missing here ({error}); install it with: pip install 'jointfmu[fem]', "
        "and on Linux libglu1-mesa libgl1 libgomp1 libxcursor1 libxft2 libxinerama1"
    )
