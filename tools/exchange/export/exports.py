"""Exports that a joint offers (constant EXPORTS of the module `export` in its folder), and file formats.

This module and the joints' modules do not load scipy before a file is written, because the help of the
command line reads them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field
from typing import TYPE_CHECKING, Any

from jointfmu.joints import KINDS
from jointfmu.joints.model import Variable
from jointfmu.quantity import Array, flatten_fields

from ...common.joint_parts import load_tool_module

if TYPE_CHECKING:
    from jointfmu.mechanics.curve import Curve

    from .mesh import NodePairs
    from .tables import LoadTable
    from .target_model import Springs, TargetModel


CONTENTS_BY_FORMAT = {
    "ansys": ("springs",),
    "calculix": ("springs", "contact"),
    "abaqus": ("springs", "contact"),
    "nastran": ("springs",),
    "aster": ("springs",),
    "modelica": ("curve",),
    "csv": ("springs", "contact", "curve"),
}
"""{format: contents that a file of this format can have}."""
STIFFNESS_FORMATS = ("ansys", "calculix", "abaqus", "nastran", "aster")
"""Formats whose springs are the stiffness matrix of the complete joint, if its sides are elastic."""
INTERFACE_FORMATS = ("ansys", "calculix", "abaqus", "csv")
"""Formats that can have springs of the interface alone, between node pairs."""
ROBOT_FORMATS = ("mjcf", "urdf")
"""Formats of robot simulators; a file has a drive."""
EXPORT_CONTENTS = ("springs", "contact", "curve")
"""Contents of a joint that can be exported: springs, contact law, load curve."""
DEFAULT_MAX_LOAD_ERROR = 1e-3
"""Default for the largest relative error of the load [1] when a table is interpolated linearly."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadCurveExport:
    """Export of the load of the complete joint as a function of displacement, as a table.

    curve_meaning   : content of the file in words
    curve_variables : variables displacement, load and stiffness
    table_name      : name of the table in a Modelica file
    compute_table   : (parameters, working point or None, largest error [1]) -> table
    """

    curve_meaning: str
    curve_variables: Sequence[Variable]
    table_name: str
    compute_table: "Callable[[Any, Any, float], LoadTable]"


@dataclass(frozen=True, slots=True, kw_only=True)
class JointExports:
    """Functions that export a kind of joint, one for each content (springs, contact law, load curve).

    A function is None if the joint cannot export the content.

    working_point_class : dataclass of the working point: load and temperature for the stiffness.
                          The user must state the first quantity; the others have defaults
    springs             : (parameters, working point, node pairs of the user or None, user's model) ->
                          springs, and their description; the working point is None if the pairs state the
                          pressure
    stiffness           : (parameters, working point) -> tangent stiffness (6, 6) [N/m, N, N.m/rad] of the
                          complete joint about the centroid of the contact
    contact             : parameters -> pressure [Pa] as a function of approach [m], and comment lines
    curve               : load as a function of displacement; needs the working point if the joint has one
    missing_reasons     : {content: why it cannot be written, and which content can}
    """

    working_point_class: type[object] | None = None
    springs: "Callable[[Any, Any, NodePairs | None, TargetModel], tuple[Springs, str]] | None" = None
    stiffness: Callable[[Any, Any], Array] | None = None
    contact: "Callable[[Any], tuple[Curve, Sequence[str]]] | None" = None
    curve: LoadCurveExport | None = None
    missing_reasons: Mapping[str, str] = field(default_factory=dict)

    @property
    def working_point(self) -> dict[str, str]:
        """Quantities (load, temperature) that define the working point: {name: meaning, unit, default}."""
        declared = flatten_fields(self.working_point_class) if self.working_point_class else ()
        return {
            name: f"{item.metadata['doc']} [{item.metadata['unit']}]"
            + ("" if item.default is MISSING else f" (default: {item.default:g})")
            for name, item in declared
        }


def load_joint_exports(joint_name: str) -> JointExports:
    """Load the export functions of a joint, from the module `export` in its folder."""
    module = load_tool_module(KINDS[joint_name], "export")
    exports: JointExports = module.EXPORTS if module else JointExports()
    return exports


def find_joints_with_export(export_content: str) -> list[str]:
    """Names of the joints that can export a content: springs, contact or curve."""
    return [joint for joint in KINDS if getattr(load_joint_exports(joint), export_content)]


def require_export(joint_name: str, export_content: str) -> Any:
    """Return the function that exports springs, contact or curve of a joint; ValueError if there is none."""
    exports = load_joint_exports(joint_name)
    if export_content in exports.missing_reasons:
        raise ValueError(
            f"the {export_content} of a {joint_name} cannot be exported: "
            f"{exports.missing_reasons[export_content]}"
        )
    if not getattr(exports, export_content):
        raise ValueError(
            f"{export_content} of a {joint_name} cannot be written; allowed is a "
            f"{', '.join(find_joints_with_export(export_content))}"
        )
    return getattr(exports, export_content)
