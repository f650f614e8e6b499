"""The plates of a drawing by finite elements."""

from collections.abc import Sequence

from jointfmu.mechanics.curve import approach_curve
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.parameters import ParameterFile

from ....drawing.vdi2230 import ClampedPart


def with_computed_field(
    file: ParameterFile,
    plate: BoltedPlate,
    layers: Sequence[ClampedPart],
    bearing: float,
    density: Sequence[float],
    preload: float,
) -> ParameterFile:
    """The joint with the pressure of two elastic plates in contact instead of the cones of its bolts.

    layers : of side 1 and 2; bearing : [m] diameter under head and nut; density : [kg/m3] of the sides
    preload : [N] of each bolt

    Raises ValueError for heads that overlap or leave the plate, and if a package is missing.
    """
    try:
        from ....fem.bolted_contact import BoltedContact
        from ....fem.bolts import BoltList
        from ....fem.geometry import Assembly, Plate
        from ....fem.joint_file import with_solution
    except ImportError as error:
        raise _missing(error) from None
    sides = [
        Plate(
            length=plate.length,
            width=plate.width,
            thickness=layer.thickness,
            E=layer.E,
            nu=file.flat[f"side{i + 1}.nu"],
            density=density[i],
        )
        for i, layer in enumerate(layers)
    ]
    bolts = BoltList(x=plate.x, y=plate.y, hole_diameter=plate.hole_diameter, head_diameter=bearing)
    assembly = Assembly(file.name, sides[0], sides[1], bolts)
    try:
        solution = BoltedContact.of(assembly).solve(approach_curve(file.values), preload)
    except (ImportError, OSError) as error:
        raise _missing(error) from None
    return with_solution(file, solution, preload)


def _missing(error: Exception) -> ValueError:
    return ValueError(
        f"--field computed needs what is missing here ({error}); install it with: "
        "pip install 'jointfmu[fem]', and on Linux libglu1-mesa libxcursor1 libxft2 libxinerama1"
    )
