"""Additions of a joint to the laboratory page: curves, sliders, points, maps.

A joint defines them by the constant LABORATORY_MODELS, {FMU: LaboratoryModel}, of its module for the tool
`laboratory` (tools/joints).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from jointfmu_fmu_src.joint_parts import RampPanel


class PublishedQuantity(NamedTuple):
    """Variables of an FMU that correspond to a published quantity, such as peak pressure, and its arguments.

    output_name          : output that equals the published quantity
    variable_by_argument : {argument of the published quantity: input or parameter of the FMU}
    """

    output_name: str
    variable_by_argument: Mapping[str, str]


class MeasuredCurve(NamedTuple):
    """Measured curve of the literature, to compare with a panel of the laboratory page.

    label, source      : name of the curve, source of the data
    abscissa, ordinate : variables of the panel
    x, y               : values (n) in SI units; the page multiplies y by the parameter `scale_parameter`
    """

    label: str
    source: str
    abscissa: str
    ordinate: str
    x: Sequence[float]
    y: Sequence[float]
    scale_parameter: str


class ContactMap(NamedTuple):
    """Map of a quantity (pressure) over the contact area, drawn on the laboratory page.

    The C function `lab_map` in the file `map.c` of the joint computes the quantity.

    si_unit, display_unit  : units of the quantity: in the C function, on the page
    compute_mark_positions : parameter set -> positions (n, 2) [m] of n marks (such as bolts), may be empty;
                             and text on what the marks are
    """

    quantity_name: str
    si_unit: str
    display_unit: str
    meaning: str
    compute_mark_positions: Callable[[Any], tuple[Sequence[Sequence[float]], str]]


class TransmissionView(NamedTuple):
    """Animation of a transmission: an input shaft turns, an output shaft follows against a load.

    input_angle, speed       : inputs of the FMU: angle and speed of the input shaft
    follower, follower_speed : inputs of the FMU: angle and speed of the output shaft
    torque, load             : outputs of the FMU: torque on the input shaft, torque on the output shaft
    error                    : output of the FMU: transmission error, positive if the output shaft leads
    ratio, rated             : parameters: transmission ratio input/output, typical load
    default_speed            : speed of the input shaft [rad/s]
    """

    input_angle: str
    speed: str
    follower: str
    follower_speed: str
    torque: str
    load: str
    error: str
    ratio: str
    rated: str
    default_speed: float


class ExampleValues(NamedTuple):
    """Values of variables that a button on the page sets to show an effect of the joint; description."""

    doc: str
    values: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class LaboratoryModel:
    """Additions of a joint to the laboratory page of one of its models.

    additional_panels : curves in addition to the curves of the FMU's documentation
    slider_spans      : {variable: (lower, upper end of its slider [SI])}, in place of the computed ends
    pointer_inputs    : inputs that the user varies with the pointer; empty: the input of the ramp
    published_points  : {quantity of a reference file: its output and arguments in the FMU}
    measured_curves   : measured curves of other joints
    contact_map       : map of a quantity over the contact
    transmission_view : animation of two shafts
    example_values    : values that a button sets
    """

    additional_panels: Sequence[RampPanel] = ()
    slider_spans: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    pointer_inputs: Sequence[str] = ()
    published_points: Mapping[str, PublishedQuantity] = field(default_factory=dict)
    measured_curves: Sequence[MeasuredCurve] = ()
    contact_map: ContactMap | None = None
    transmission_view: TransmissionView | None = None
    example_values: ExampleValues | None = None
