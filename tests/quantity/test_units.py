"""Table of units: sizes and exponents against independent ones; it has all units in use."""

import numpy as np
import pytest
from jointfmu_fmu_src.partners import PARTNERS
from jointfmu_tools.exchange.export import tables
from jointfmu_tools.exchange.export.mesh import COLUMN_UNITS as PAIRS
from jointfmu_tools.exchange.export.target_model import UNIT_SETS as SETS
from jointfmu_tools.fem.geometry import BoxSection, Layer, Plate
from jointfmu_tools.inputs.fields.nodal_result import FIELD_COLUMN_UNITS as FIELD
from jointfmu_tools.inputs.surfaces.csvfile import LENGTH_UNITS
from jointfmu_tools.joints.bolted_joint.fit import preload
from jointfmu_tools.joints.harmonic_drive.fit import torque_angle
from jointfmu_tools.systems.system import load_systems
from scipy import constants

from jointfmu.joints import KINDS, MODELS
from jointfmu.quantity import flatten_fields
from jointfmu.quantity.units import (
    UNITS,
    base_exponents,
    conversion_factor,
    display_unit,
    replace_symbols,
    unit_size,
    unit_sizes,
)

SIZES = {
    "mm": constants.milli,
    "um": constants.micron,
    "µm": constants.micron,
    "μm": constants.micron,
    "nm": constants.nano,
    "mm2": constants.milli**2,
    "um2": constants.micron**2,
    "kN": constants.kilo,
    "kPa": constants.kilo,
    "MPa": constants.mega,
    "GPa": constants.giga,
    "mN.m": constants.milli,
    "kN.m": constants.kilo,
    "N.mm": constants.milli,
    "mrad": constants.milli,
    "deg": constants.degree,
    "arcmin": constants.arcmin,
    "arcsec": constants.arcsec,
    "rev/min": 2.0 * constants.pi / constants.minute,
    "kHz": constants.kilo,
    "t": constants.metric_ton,
    "mm/s": constants.milli,
    "N/um": 1.0 / constants.micron,
    "kN/mm": constants.kilo / constants.milli,
    "N.mm/rad": constants.milli,
    "N.m/arcmin": 1.0 / constants.arcmin,
    "kN.s/m": constants.kilo,
    "N.s/mm": 1.0 / constants.milli,
    "N/mm3": 1.0 / constants.milli**3,
    "MPa/um": constants.mega / constants.micron,
    "MPa/um2": constants.mega / constants.micron**2,
}
TENS = {
    "1e4 N.m/rad": (1e4, "N.m/rad"),
    "x10^4 Nm/rad": (1e4, "N.m/rad"),
    "\u00d710\u2074 N·m/rad": (1e4, "N.m/rad"),
    "10^-3 N.m": (1e-3, "N.m"),
    "kgf.m/arcmin": (constants.g / constants.arcmin, "N.m/rad"),
    "Nm/deg": (1.0 / constants.degree, "N.m/rad"),
}
"""Units with powers of ten, as in column headings of catalogues."""
EXPONENTS = {  # of kg, m, s, rad, K
    "1": (0, 0, 0, 0, 0),
    "s": (0, 0, 1, 0, 0),
    "Hz": (0, 0, -1, 0, 0),
    "rad": (0, 0, 0, 1, 0),
    "rad/s": (0, 0, -1, 1, 0),
    "rad/s2": (0, 0, -2, 1, 0),
    "m": (0, 1, 0, 0, 0),
    "m/s": (0, 1, -1, 0, 0),
    "m/s2": (0, 1, -2, 0, 0),
    "m2": (0, 2, 0, 0, 0),
    "N": (1, 1, -2, 0, 0),
    "N.m": (1, 2, -2, 0, 0),
    "N.m/rad": (1, 2, -2, -1, 0),
    "N.m.s/rad": (1, 2, -1, -1, 0),
    "N/m": (1, 0, -2, 0, 0),
    "N.s/m": (1, 0, -1, 0, 0),
    "N/m3": (1, -2, -2, 0, 0),
    "Pa": (1, -1, -2, 0, 0),
    "Pa/m": (1, -2, -2, 0, 0),
    "Pa/m2": (1, -3, -2, 0, 0),
    "J": (1, 2, -2, 0, 0),
    "W": (1, 2, -3, 0, 0),
    "kg": (1, 0, 0, 0, 0),
    "kg.m2": (1, 2, 0, 0, 0),
    "kg/m3": (1, -3, 0, 0, 0),
    "K": (0, 0, 0, 0, 1),
    "1/K": (0, 0, 0, 0, -1),
}


@pytest.mark.parametrize("written", TENS)
def test_units_of_catalogues(written):
    expected, unit = TENS[written]
    assert conversion_factor(written, unit) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("wrong", ["1e4", "1e99 N.m", "10^ N.m", "1e4 1e4 N"])
def test_a_power_of_ten_alone_is_no_unit(wrong):
    with pytest.raises(ValueError, match="unit"):
        conversion_factor(wrong, "N.m")


@pytest.mark.parametrize("unit", SIZES)
def test_size(unit):
    assert unit_size(unit) == pytest.approx(SIZES[unit], rel=4e-16)  # a rounding or two of the product here


@pytest.mark.parametrize("unit", UNITS)
def test_exponents(unit):
    expected = dict(zip(("kg", "m", "s", "rad", "K"), EXPONENTS[unit], strict=True))
    assert (
        UNITS[unit].base_exponents == base_exponents(unit) == {name: n for name, n in expected.items() if n}
    )
    assert unit_size(unit) == 1.0


@pytest.mark.parametrize("unit", UNITS)
def test_display_units_measure_the_same(unit):
    for shown, times in UNITS[unit].display_factors.items():
        assert base_exponents(shown) == base_exponents(unit)
        assert times * unit_size(shown) == pytest.approx(
            1.0, rel=2e-16
        )  # one is the other's inverse, rounded


def test_quantities_name_one_unit_each():
    names = [unit.quantity for unit in UNITS.values()]
    assert sorted(names) == sorted(set(names))


@pytest.mark.parametrize(("typical", "shown"), [(0.0, "mm"), (1e-2, "mm"), (3e-5, "um"), (30.0, "mm")])
def test_display_unit_is_the_one_nearest_to_30(typical, shown):
    assert display_unit("m", typical) == shown


def test_sizes_are_of_one_kind():
    assert unit_sizes("Pa", "kPa", "MPa") == {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6}
    assert conversion_factor("MPa", "kPa") == 1e3
    with pytest.raises(ValueError, match="unit 'N' measures another quantity than 'Pa'"):
        unit_sizes("Pa", "N")


@pytest.mark.parametrize(
    ("written", "ours"),
    [
        ("Nm", "N.m"),
        ("N·m", "N.m"),
        ("N*m", "N.m"),
        ("kNm", "kN.m"),
        ("mNm", "mN.m"),
        ("Nmm", "N.mm"),
        ("Ncm/arcmin", "N.cm/arcmin"),
        ("Nm/rad", "N.m/rad"),
        ("mm²", "mm2"),
        ("N/mm^2", "MPa"),
        ("N/m³", "N/m3"),
        ("kg·m²", "kg.m2"),
        ("°", "deg"),
        ("degrees", "deg"),
        ("\u2032", "arcmin"),
        ("µrad", "urad"),
        ("kgfm", "kgf.m"),
        ("min", "min"),
    ],
)
def test_units_as_people_write_them(written, ours):
    assert (unit_size(written), base_exponents(written)) == (unit_size(ours), base_exponents(ours))


def test_kilogram_force():
    assert unit_size("kgf.m") == constants.g
    assert unit_size("kgf.m/arcmin") == pytest.approx(constants.g / constants.arcmin, rel=1e-15)


@pytest.mark.parametrize(
    "unit", ["in", "mmm", "kkg", "", "N/", "N/m/s", "N m", "m-2", "11", "kmin", "u", "Nx"]
)
def test_what_is_no_unit_is_refused_by_name(unit):
    with pytest.raises(ValueError, match=f"unit '{unit}'"):
        unit_size(unit)


def test_other_symbols_keep_exponents():
    assert replace_symbols("N.m.s/rad", {"m": "mm", "s": "min"}) == "N.mm.min/rad"
    assert replace_symbols("Pa/m2", {"m": "mm", "Pa": "MPa"}) == "MPa/mm2"
    assert replace_symbols("1", {"m": "mm"}) == "1"


def test_sets_are_consistent():
    """Newton's law, and pressure as force over area, have no factor in a set of units."""
    for one in SETS.values():
        assert conversion_factor(one.unit_symbol("kg.m/s2"), one.unit_symbol("N")) == 1.0
        assert conversion_factor(one.unit_symbol("N/m2"), one.unit_symbol("Pa")) == 1.0
        assert conversion_factor(one.unit_symbol("kg/s2"), one.unit_symbol("N/m")) == 1.0


def declared():
    """Every SI unit that a parameter, a variable, a system or a file declares: (place, unit)."""
    for cls in (*(kind.default_parameter_class for kind in KINDS.values()), Layer, Plate, BoxSection):
        for name, item in flatten_fields(cls):
            if "unit" in item.metadata:
                yield f"{cls.__name__}.{name}", item.metadata["unit"]
    for name, model in (MODELS | PARTNERS).items():
        yield from ((f"{name}.{v.name}", v.unit) for v in (*model.inputs, *model.outputs))
        for field, item in model.parameter_fields().items():
            if "unit" in item.metadata:
                yield f"{name}.{field}", item.metadata["unit"]
    for name, example in load_systems().items():
        for part in example.components.values():
            yield from (
                (f"{name}.{part.name}.{key}", unit) for key, unit in part.stated_units.items() if unit
            )
    for spec in (preload.COLUMN_UNITS, torque_angle.COLUMN_UNITS, PAIRS, FIELD, {"height": LENGTH_UNITS}):
        yield from ((name, next(iter(units))) for name, units in spec.items())
    yield from (*tables.LABEL_COLUMN_HEADS, *tables.SPRING_COLUMN_HEADS)


def test_no_unit_is_declared_that_the_table_lacks():
    found = dict(declared())
    assert len(found) > 100
    assert {where: unit for where, unit in found.items() if unit not in UNITS} == {}


def test_factors_of_one_are_exact():
    values = np.array([0.1, 1.0 / 3.0])
    np.testing.assert_array_equal(values * conversion_factor("N.m", "J"), values)
