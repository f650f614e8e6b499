"""Names and rules of FMI-LS-REF, as an FMU with a proof states them."""

NAME = "org.fmi-standard.fmi-ls-ref"
"""Of the layered standard."""
VERSION = "1.0.0-alpha.1"
DESCRIPTION = "Layered Standard providing information on related files included in an FMU."
FOLDER = f"extra/{NAME}"
MANIFEST = f"{FOLDER}/fmi-ls-manifest.xml"
ATTRIBUTES = "http://fmi-standard.org/fmi-ls-manifest"
"""Namespace of the manifest's own attributes."""
EXPERIMENTS, SSV, CSV = "application/x-ma-hs-experiments", "application/x-ssp-parameter-set", "text/csv"
"""Types of related files that are read."""
TRANSIENT = "TransientSimulation"
CO_SIMULATION, MODEL_EXCHANGE = INTERFACES = ("co-simulation", "model exchange")
"""Interfaces of FMUs."""
LABELS = {name: f"interface:{name.replace(' ', '-')}" for name in INTERFACES}
"""{interface: label of a file of experiments for it}; without such a label it is for all."""
SCALES = "org.jointfmu.scales"
"""Type of an experiment's annotation: the size of each output by which its tolerance counts."""
PURPOSES = ("smoke-test", "validation", "uncertainty-analysis")
"""What an experiment is for; the first where a manifest does not say."""
FLOOR = 1e-6
"""Part of an output's nominal value [1] below which its round-off counts, not its own size."""
SOLVER = 1e-3
"""Relative tolerance of a solver over that of the experiment [1]: its errors add up along the way, and
what was large may be small after an event."""
