"""Properties of the harmonic drive for the shared tests."""

import math

from case import Beyond, Case, Description, Joint, Numbers, Refusals, Refused, Study, Tuning

from jointfmu.parameters import load_default

PARAMETERS = {
    "surface.D": "1", "surface.G": "m", "surface.gamma": "1", "surface.r_m": "m", "surface.s_min": "m2",
    "flexspline.E": "Pa", "flexspline.nu": "1", "flexspline.sigma_y": "Pa",
    "bearing.E": "Pa", "bearing.nu": "1", "bearing.sigma_y": "Pa",
    "mu": "1", "radial_deformation": "m", "eccentricity": "m", "ratio": "1", "K_FTS0": "N.m/rad",
    "d": "N.m.s/rad", "hysteresis_loss": "rad", "hysteresis_stiffness": "N.m/rad", "lost_motion": "rad",
}  # fmt: skip
STIFFNESS = {"K_WTS": "N.m/rad", "K_TS": "N.m/rad", "K_FTS": "N.m/rad", "E_loss": "J"}
CALIBRATED = frozenset({"K_FTS0", "zero_torque_pressure", "rated_pressure"})
FRICTION = {
    "friction_coulomb": 0.02,
    "friction_stribeck": 0.01,
    "stribeck_speed": 2.0,
    "friction_viscous": 1e-3,
    "load_loss": 0.1,
    "presliding": 0.02,
    "temperature_factor": 1.2,
    "viscous_temperature_coefficient": 0.03,
    "dry_temperature_coefficient": 0.01,
}
MOTION = ("phi1", "w1", "phi2", "w2", "temperature")
WARM = {"temperature": (253.15, 353.15)}
"""Range of the temperature input [K]: -20 to 80 degrees C."""
UNITS = {
    "friction_coulomb": "N.m",
    "friction_stribeck": "N.m",
    "friction_viscous": "N.m.s/rad",
    "load_loss": "1",
    "load_loss_back": "1",
    "friction_1": "N.m",
    "friction_1_phase": "rad",
    "friction_2": "N.m",
    "friction_2_phase": "rad",
}
RIPPLE = {"friction_1": 0.005, "friction_1_phase": 0.9, "friction_2": 0.003, "friction_2_phase": -0.6}
ERROR = {
    "error_1": 2e-5,
    "error_1_phase": 0.7,
    "error_2": 1e-4,
    "error_2_phase": -0.4,
    "error_4": 3e-5,
    "error_4_phase": 2.0,
}
INERTIA = {"inertia1": 1e-4}
BASE = {"eccentricity": 1e-5, "hysteresis_loss": 3e-4, "hysteresis_stiffness": 8e3, "lost_motion": 1e-4}
"""Parameter set with all effects that are off by default."""
MOVED = {
    "load_loss_back": 0.3,
    "bearing.sigma_y": 0.8 * load_default("harmonic_drive").values.flexspline.sigma_y,
}
"""Changed parameters; parameters of the softer body have an effect."""
ELASTIC = frozenset({"mu", "surface.s_min", "flexspline.sigma_y", "bearing.sigma_y"})
"""Parameter set with elastic spots only: spot size and strength limit the validity. The traction ratio is
relative to mu."""

SPRING = Case(
    name="HarmonicDriveSpring",
    description=Description(
        inputs={"phi1": "rad", "w1": "rad/s", "phi2": "rad", "w2": "rad/s", "temperature": "K"},
        results={
            "tau1": "N.m",
            "tau2": "N.m",
            "phi_rel": "rad",
            "tau": "N.m",
            **STIFFNESS,
            "phi_error": "rad",
            "tau_friction": "N.m",
            "step_at_once": "s",
            "step_side_by_side": "s",
        },
        parameters=PARAMETERS | dict.fromkeys(ERROR, "rad") | UNITS,
        calibration=CALIBRATED,
        shown={"phi2": "deg", "temperature": "degC"},
        flanges={"flange1": "phi1 w1 tau1", "flange2": "phi2 w2 tau2"},
        domain="Rotational",
        linear=True,
        others={"ratio": 50.0, "d": 0.25},
    ),
    numbers=Numbers(
        outputs=lambda spring, v: spring.evaluate_motion(*(v[name] for name in MOTION)),
        ranges={"phi1": (-0.1, 0.1), "w1": (-50, 50), "phi2": (-3e-3, 3e-3), "w2": (-0.5, 0.5), **WARM},
        span={"phi1": (-0.05, 0.05), "w1": (-50, 50), "phi2": (-3.8e-3, 3.8e-3), "w2": (-0.5, 0.5), **WARM},
        state={"phi1": 0.01, "w1": 0.3, "phi2": 6e-4, "w2": -0.02, "temperature": 310.0},
        good={"phi2": 6e-4},
    ),
    tuning=Tuning(
        base=BASE | ERROR | FRICTION | RIPPLE | INERTIA,
        moved=MOVED,
        without_effect=ELASTIC,
        tuned={"surface.D": 2.55, "ratio": 80.0, "d": 1.0, "flexspline.E": 1.9e11},
        baked=({"traction": "real_area", "shear_traction": 5e5, "max_torque": 10.0, "d": 0.9},),
    ),
    refusals=Refusals(
        beyond=(Beyond("phi2", 0.01, "tau", "K_WTS", "phi_rel = 0.01 rad"),),
        refused=(
            Refused("surface.D", 2.0, "2", "(2, 3)"),
            Refused("surface.D", 3.5, "3.5", "(2, 3)"),
            Refused("surface.gamma", 1.0, "1", "(1, inf)"),
            Refused("eccentricity", -1e-5, "-1e-05 m", "[0, 0.001)"),
            Refused("radial_deformation", 3e-3, "0.003 m", "(0, 0.002)"),
            Refused("d", math.inf, "inf N.m.s/rad", "[0, inf)"),
            Refused("ratio", 0.0, "0", "(0, inf)"),
        ),
        unfit=(({"rated_pressure": 1e6}, ("rated_pressure = 1e+06 Pa", "zero_torque_pressure")),),
        forbidden=(
            {"rated_pressure": 1e6},
            {"flexspline.sigma_y": 3e8},
            {"radial_deformation": 1e-4},
            {"surface.G": 2e-307},
            {"torque_smoothing": 5e-302},
        ),
    ),
)
COMPLIANCE = Case(
    name="HarmonicDriveCompliance",
    description=Description(
        inputs={"tau": "N.m"},
        results={"phi_rel": "rad", **STIFFNESS},
        parameters=PARAMETERS,
        calibration=CALIBRATED,
        shown={"phi_rel": "arcmin"},
        steps=500,
        flanges={"flange": "phi_rel tau"},
        domain="Rotational",
    ),
    numbers=Numbers(
        outputs=lambda spring, v: spring.evaluate_torque(v["tau"]),
        ranges={"tau": (-25, 25)},
        span={"tau": (-30, 30)},
        state={"tau": 3.0},
        good={"tau": 3.0},
    ),
    tuning=Tuning(
        base=BASE,
        moved=MOVED,
        without_effect=ELASTIC | {"ratio", "d"},  # the wave generator is locked and there is no speed
        tuned={"surface.D": 2.55, "K_FTS0": 2e4, "radial_deformation": 1.9e-4},
        baked=({"max_torque": 20.0, "surface.D": 2.55},),
    ),
    refusals=Refusals(
        beyond=(Beyond("tau", 100.0, "phi_rel", "K_WTS", "tau = 100 N.m", inverse=True),),
        refused=(
            Refused("K_FTS0", math.nan, "nan N.m/rad", "(0, inf)"),
            Refused("flexspline.sigma_y", -835e6, "-835000000 Pa", "(0, inf)"),
            Refused("bearing.nu", 0.6, "0.6", "(-1, 0.5]"),
        ),
        unfit=(({"eccentricity": 9e-4}, ("eccentricity = 0.0009 m is outside [0, ",)),),
        forbidden=(
            {"eccentricity": 9e-4},
            {"bearing.sigma_y": 3e8},
            {"surface.G": 1e-100},  # K_FTS0 and what the contact pair adds
        ),
        absurd=(("K_FTS0", 1e-300),),
    ),
)
JOINT = Joint(
    cases=(SPRING, COMPLIANCE),
    varied="surface.D",
    scaled="surface.G",
    studies={
        "wide": Study(
            {
                "surface.D": "2.3..2.7",
                "surface.G": "loguniform(2e-8, 1e-6)",
                "eccentricity": "0..3e-5",
                "radial_deformation": "+-3%",
                "zero_torque_pressure": "+-10%",
                "K_FTS0": "lognormal(20%)",
                "tau": "+-20%",
            },
            200,
        ),
        "geometry": Study(
            {
                "mean_over_peak": "+-20%",
                "A_0": "+-20%",
                "radius": "+-5%",
                "flexspline.E": "+-10%",
                "max_torque": "10..40",
                "torque_smoothing": "loguniform(0.02, 0.2)",
            },
            100,
        ),
        "surface": Study(
            {"surface.r_m": "loguniform(1e-7, 1e-5)", "flexspline.sigma_y": "loguniform(6e8, 3e9)"},
            100,
        ),
    },
    unloaded=frozenset({"K_WTS"}),
)
