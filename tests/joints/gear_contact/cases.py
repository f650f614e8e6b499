"""Properties of the gear contact for the shared tests."""

import math

from case import Beyond, Case, Description, Joint, Numbers, Refusals, Refused, Study, Tuning

GEAR = Case(
    name="GearContact",
    description=Description(
        inputs={"f": "N"},
        results={"s_rel": "m", "K_N": "N/m", "A_r": "m2", "elastic_fraction": "1"},
        parameters={
            "surface1.D": "1", "surface1.G": "m", "surface2.D": "1", "surface2.G": "m",
            "surface.gamma": "1", "e": "1", "lambda": "1",
            "side1.E": "Pa", "side1.nu": "1", "side2.E": "Pa", "side2.nu": "1", "sigma_y": "Pa", "A_0": "m2",
        },
        shown={"f": "kN", "K_N": "N/um", "s_rel": "um"},
        steps=300,
        flanges={"flange": "s_rel f"},
        domain="Translational",
    ),
    numbers=Numbers(
        outputs=lambda spring, v: spring.evaluate(v["f"]),
        ranges={"f": (1, 6e4)},
        span={"f": (0, 6e4)},
        state={"f": 2e4},
        good={"f": 900.0},
    ),
    tuning=Tuning(
        base={"rigid_flat": False},  # with a rigid flat the second body does not matter
        without_effect=frozenset({"A_0"}),  # the load alone decides the spots
        tuned={"surface1.D": 1.5, "e": 0.4, "rigid_flat": False, "sigma_y": 3e8},
        baked=({"plastic_area": "kogut_etsion", "rigid_flat": False, "e": 0.3},),
    ),
    refusals=Refusals(
        beyond=(Beyond("f", 1e6, "s_rel", "K_N", "f = 1e+06 N", inverse=True),),
        refused=(
            Refused("surface2.G", 0.0, "0 m", "(0, inf)"),
            Refused("e", math.nan, "nan", "[0, 1)"),
            Refused("lambda", 1.0000001, "1.0000001", "(0, 1]"),
        ),
        forbidden=({"e": 1.0, "sigma_y": -1.0},),  # both are named
        absurd=(("surface1.G", 1e300),),
    ),
)  # fmt: skip
JOINT = Joint(
    cases=(GEAR,),
    varied="surface1.D",
    scaled="surface1.G",
    studies={
        "surfaces and load": Study(
            {
                "surface1.D": "1.35..1.6",
                "surface2.D": "1.35..1.6",
                "surface1.G": "loguniform(2e-11, 1e-9)",
                "e": "0.05..0.7",
                "lambda": "0.7..1",
                "sigma_y": "+-20%",
                "f": "+-10%",
            },
            100,
        ),
    },
)
