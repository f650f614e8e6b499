"""Properties of the bolted joint for the shared tests."""

import math
from typing import Any

from case import Beyond, Case, Description, Inputs, Joint, Numbers, Refusals, Refused, Study, Tuning

RANGES = {
    "preload": (2e3, 3e4), "moment": (-1500, 1500),
    "s_rel_x": (-2e-6, 2e-6), "s_rel_y": (-2e-6, 2e-6), "s_rel_z": (-1e-6, 3e-6),
    "v_rel_x": (-1e-3, 1e-3), "v_rel_y": (-1e-3, 1e-3), "v_rel_z": (-1e-3, 1e-3),
    "theta_x": (-1e-5, 1e-5), "theta_y": (-1e-5, 1e-5), "theta_z": (-1e-5, 1e-5),
    "omega_x": (-1e-2, 1e-2), "omega_y": (-1e-2, 1e-2), "omega_z": (-1e-2, 1e-2),
    "temperature": (263.15, 363.15),
}  # fmt: skip


def outputs(spring: Any, v: Inputs) -> Any:
    """Outputs of the spring at a motion."""
    kinds = ("s_rel", "v_rel", "theta", "omega")
    return spring.evaluate(
        v["preload"],
        v["moment"],
        *(tuple(v[f"{kind}_{axis}"] for axis in "xyz") for kind in kinds),
        temperature=v["temperature"],
    )


BOLTED = Case(
    name="BoltedJoint",
    description=Description(
        inputs={
            "preload": "N", "moment": "N.m", "s_rel_x": "m", "s_rel_y": "m", "s_rel_z": "m",
            "v_rel_x": "m/s", "v_rel_y": "m/s", "v_rel_z": "m/s",
            "theta_x": "rad", "theta_y": "rad", "theta_z": "rad",
            "omega_x": "rad/s", "omega_y": "rad/s", "omega_z": "rad/s", "temperature": "K",
        },
        results={
            "f_x": "N", "f_y": "N", "f_z": "N", "m_x": "N.m", "m_y": "N.m", "m_z": "N.m",
            "K_xx": "N/m", "K_yy": "N/m", "K_zz": "N/m",
            "C_xx": "N.s/m", "C_yy": "N.s/m", "C_zz": "N.s/m", "eta_t": "1", "eta_n": "1",
            "K_rx": "N.m/rad", "K_ry": "N.m/rad", "K_rz": "N.m/rad", "p_mean": "Pa", "p_max": "Pa",
            "slip": "1", "E_loss": "J", "eta_loop": "1", "C_loop": "N.s/m",
            "step_at_once": "s", "step_side_by_side": "s",
        },
        parameters={
            "surface.D": "1", "surface.G": "m", "surface.gamma": "1",
            "side1.E": "Pa", "side1.nu": "1", "side2.E": "Pa", "side2.nu": "1", "H": "Pa", "mu": "1",
            "traction_ratio": "1", "A_0": "m2", "mass": "kg", "n_bolts": "1", "row_distance": "m",
            "bolt_stiffness": "N/m", "bolt.alpha": "1/K", "side1.alpha": "1/K", "side2.alpha": "1/K",
        },
        shown={"p_max": "MPa", "preload": "kN", "K_zz": "N/um", "s_rel_z": "um"},
        steps=300,
        flanges={f"flange_{a}": f"s_rel_{a} v_rel_{a} f_{a}" for a in "xyz"}
        | {f"flange_turn_{a}": f"theta_{a} omega_{a} m_{a}" for a in "xyz"},
        domain="Translational Rotational",
    ),
    numbers=Numbers(
        outputs=outputs,
        ranges=RANGES,
        span=RANGES,
        state={
            "preload": 9e3, "moment": 800.0, "s_rel_x": 1e-6, "s_rel_y": -2e-6, "s_rel_z": 5e-7,
            "v_rel_x": 1e-3, "v_rel_y": 2e-3, "v_rel_z": -1e-3,
            "theta_x": 1e-6, "theta_y": -2e-6, "theta_z": 3e-6,
            "omega_x": 1e-3, "omega_y": 2e-3, "omega_z": -1e-3, "temperature": 310.0,
        },
        good={"preload": 9e3},
        rest={"preload": 1e4},
        jumps=frozenset({"K_zz", "K_rx", "K_ry", "eta_loop", "C_loop"}),
        kinks=frozenset({"f_x", "f_y", "m_z", "slip", "K_xx", "K_yy", "K_rz", "E_loss"})  # of single sliders
        | {"step_at_once", "step_side_by_side"},  # the least of three
    ),
    tuning=Tuning(
        # off, they are zero
        base={
            "plastic_damping": True, "bolt_stiffness": 1e8, "embedding": 500.0, "damping": True,
            "plate_stiffness": 3e8, "bolt.alpha": 1.2e-5, "side1.alpha": 1.1e-5, "side2.alpha": 2.3e-5,
            "side1.clamped_length": 0.02, "side2.clamped_length": 0.03,
        },
        also={"memory": False},  # then shear lifts
        moved={"n_bolts": 9.0, "row_bolts": 2.0},  # whole numbers
        counted={"n_bolts": (8, 12), "row_bolts": (1, 4)},
        without_effect=frozenset({"row_bolts"}),  # only where a row opens (a warning)
        tuned={"surface.D": 1.45, "n_bolts": 10.0, "mass": 20.0, "side1.nu": 0.25, "bolt_stiffness": 2e8},
        baked=(
            {"critical_area": "printed", "spot_stiffness": "hertz", "pattern.decay_length": 0.05},
            {"critical_area": "yield", "bolt_stiffness": 3e8},
        ),
    ),
    refusals=Refusals(
        beyond=(Beyond("s_rel_z", -1e-3, "f_z", "K_zz", "p_max = "),),
        refused=(
            Refused("surface.D", 2.53, "2.53", "(1, 2)"),
            Refused("traction_ratio", 1.0, "1", "[0, 1)"),
            Refused("n_bolts", 0.0, "0", "[1, inf)"),
            Refused("mass", -math.inf, "-inf kg", "(0, inf)"),
        ),
        unfit=(({"row_bolts": 5.0}, ("row_bolts = 5", "[1, 4]")),),
        forbidden=(
            {"row_bolts": 5.0},
            {"n_bolts": 8.5},
            {"surface.G": 1.21e-5},
            {"surface.G": 1.21e-108},
            {"side1.E": 1.5e-9},
            {"preload": -1.0},
        ),
    ),
)  # fmt: skip
JOINT = Joint(
    cases=(BOLTED,),
    varied="surface.D",
    scaled="surface.G",
    studies={
        "surfaces and load": Study(
            {
                "surface.D": "1.36..1.48",
                "surface.G": "lognormal(30%)",
                "H": "+-10%",
                "A_0": "+-10%",
                "mass": "+-20%",
                "traction_ratio": "0.01..0.5",
                "preload": "normal(12%)",
            },
            12,
        ),
    },
)
