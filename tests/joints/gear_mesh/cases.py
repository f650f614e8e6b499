"""Properties of the gear mesh for the shared tests."""

import math

from case import Beyond, Case, Description, Inputs, Joint, Numbers, Refusals, Refused, Study, Tuning

from jointfmu.parameters import load_default

TURN = 8.0 * math.pi / 29.0
"""Angle [rad] of wheel 1 far beyond the table; half of it is a whole number of mesh cycles."""

R_B1, R_B2 = (getattr(load_default("gear_mesh").values, name) for name in ("r_b1", "r_b2"))


def rolled(inputs: Inputs) -> Inputs:
    """Inputs with wheel 2 rolled along with wheel 1, so that any phase of the mesh cycle stays inside the
    table."""
    return inputs | {"phi2": inputs["phi2"] - inputs["phi1"] * R_B1 / R_B2}


MESH = Case(
    name="GearMesh",
    description=Description(
        inputs={"phi1": "rad", "w1": "rad/s", "phi2": "rad", "w2": "rad/s"},
        results={
            "tau1": "N.m", "tau2": "N.m", "s_rel": "m", "transmission_error": "m", "f": "N", "K": "N/m",
            "step_at_once": "s", "step_side_by_side": "s",
        },
        parameters={
            "surface1.D": "1", "surface1.G": "m", "surface2.D": "1", "surface2.G": "m",
            "surface.gamma": "1", "e": "1", "lambda": "1",
            "side1.E": "Pa", "side1.nu": "1", "side2.E": "Pa", "side2.nu": "1", "sigma_y": "Pa", "A_0": "m2",
            "r_b1": "m", "r_b2": "m", "teeth1": "1", "backlash": "m", "K_tooth": "N/m", "contact_ratio": "1",
            "d": "N.s/m",
        },
        shown={"phi1": "deg", "s_rel": "um", "transmission_error": "um", "f": "kN", "K": "N/um"},
        flanges={"flange1": "phi1 w1 tau1", "flange2": "phi2 w2 tau2"},
        domain="Rotational",
    ),
    numbers=Numbers(
        outputs=lambda spring, v: spring.evaluate(v["phi1"], v["w1"], v["phi2"], v["w2"]),
        ranges={"phi1": (-0.2, 0.2), "w1": (-1.0, 1.0), "phi2": (-5e-3, 5e-3), "w2": (-1.0, 1.0)},
        place=rolled,
        span={"phi1": (-6e-3, 6e-3), "w1": (-1.0, 1.0), "phi2": (-2e-3, 2e-3), "w2": (-1.0, 1.0)},
        state={"phi1": 0.077, "w1": 0.03, "phi2": -0.0478, "w2": -0.01},  # between one pair and two
        sizes={"phi1": 2e-3, "phi2": 1e-3},
        good={"phi1": 2e-3},
        rest={"phi1": 2e-3},  # beyond the backlash
    ),
    tuning=Tuning(
        base={"rigid_flat": False, "inertia1": 0.1},  # with a rigid flat the second body does not matter
        # the load decides the spots, A_0 where the table ends; the default wheels are spur ones
        moved={"teeth1": 30.0, "A_0": 1e-6, "overlap_ratio": 0.3},
        counted={"teeth1": (25, 33)},
        tuned={"surface1.D": 1.5, "K_tooth": 2e8, "contact_ratio": 1.5, "rigid_flat": False, "d": 2e3},
        baked=({"plastic_area": "kogut_etsion", "rigid_flat": False, "e": 0.3, "backlash": 0.0},),
    ),
    refusals=Refusals(
        beyond=(Beyond("phi1", TURN, "f", "K", "s_rel = ", lever=R_B1),),
        refused=(
            Refused("surface2.G", 0.0, "0 m", "(0, inf)"),
            Refused("contact_ratio", 3.0, "3", "[1, 3)"),
            Refused("teeth1", 0.0, "0", "[1, inf)"),
            Refused("backlash", -1e-5, "-1e-05 m", "[0, inf)"),
            Refused("K_tooth", math.nan, "nan N/m", "(0, inf)"),
        ),
        forbidden=({"e": 1.0, "K_tooth": -1.0}, {"teeth1": 28.5}),
    ),
)  # fmt: skip
JOINT = Joint(
    cases=(MESH,),
    varied="surface1.D",
    scaled="surface1.G",
    studies={
        "teeth": Study({"K_tooth": "+-20%", "contact_ratio": "1.2..2.4", "phi1": "+-10%"}, 50),
    },
    unloaded=frozenset({"pairs"}),
)
