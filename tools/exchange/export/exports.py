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
    from .placing import Placement, Springs
    from .tables import LoadTable


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
    """Export of the load over the displacement of the complete joint, as a table.

    meaning       : content of the file in words
    columns       : variables displacement, load and stiffness
    table_name    : name of the table in a Modelica file
    compute_table : (parameters, working point or None, largest error [1]) -> table
    """

    meaning: str
    columns: Sequence[Variable]
    table_name: str
    compute_table: "Callable[[Any, Any, float], LoadTable]"


@dataclass(frozen=True, slots=True, kw_only=True)
class Exports:
    """Exports that a kind of joint offers; None: the joint does not offer this content.

    working_point_class : dataclass of declared quantities. The user must state the first quantity; the others
                          have defaults
    springs             : (parameters, working point, node pairs of the user or None, placement) -> springs,
                          and their description; the working point is None if the pairs state the pressure
    stiffness           : (parameters, working point) -> tangent stiffness (6, 6) [N/m, N, N.m/rad] of the
                          complete joint about the centroid of the contact
    contact             : parameters -> pressure [Pa] over approach [m], and additional comment lines
    curve               : load over displacement; it needs the working point if the joint has one
    missing_reasons     : {content: why it cannot be written, and which content can}
    """

    working_point_class: type[object] | None = None
    springs: "Callable[[Any, Any, NodePairs | None, Placement], tuple[Springs, str]] | None" = None
    stiffness: Callable[[Any, Any], Array] | None = None
    contact: "Callable[[Any], tuple[Curve, Sequence[str]]] | None" = None
    curve: LoadCurveExport | None = None
    missing_reasons: Mapping[str, str] = field(default_factory=dict)

    @property
    def working_point(self) -> dict[str, str]:
        """Quantities of the working point, the required one first: {name: meaning with unit and default}."""
        declared = flatten_fields(self.working_point_class) if self.working_point_class else ()
        return {
            name: f"{item.metadata['doc']} [{item.metadata['unit']}]"
            + ("" if item.default is MISSING else f" (default: {item.default:g})")
            for name, item in declared
        }


def load_exports(joint_name: str) -> Exports:
    """Import the exports that a joint offers."""
    module = load_tool_module(KINDS[joint_name], "export")
    exports: Exports = module.EXPORTS if module else Exports()
    return exports


def find_joints_with_export(export_kind: str) -> list[str]:
    """Names of the joints that offer a content: springs, contact or curve."""
    return [joint for joint in KINDS if getattr(load_exports(joint), export_kind)]


def require_export(joint_name: str, export_kind: str) -> Any:
    """Return a joint's springs, contact or curve. Raises ValueError if the joint does not offer it."""
    exports = load_exports(joint_name)
    if export_kind in exports.missing_reasons:
        raise ValueError(
            f"the {export_kind} of a {joint_name} cannot be exported: {exports.missing_reasons[export_kind]}"
        )
    if not getattr(exports, export_kind):
        raise ValueError(
            f"{export_kind} of a {joint_name} cannot be written; allowed is a "
            f"{', '.join(find_joints_with_export(export_kind))}"
        )
    return getattr(exports, export_kind)
