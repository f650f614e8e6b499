"""Names, types and tolerances of FMI-LS-REF, as jointfmu writes and reads them."""

LAYERED_STANDARD_NAME = "org.fmi-standard.fmi-ls-ref"
"""Name of the layered standard."""
LAYERED_STANDARD_VERSION = "1.0.0-alpha.1"
"""Version of the layered standard."""
LAYERED_STANDARD_DESCRIPTION = "Layered Standard providing information on related files included in an FMU."
"""Description of the layered standard in its manifest."""
REFERENCE_FILE_FOLDER = f"extra/{LAYERED_STANDARD_NAME}"
"""Folder in an FMU of the reference files."""
MANIFEST_PATH = f"{REFERENCE_FILE_FOLDER}/fmi-ls-manifest.xml"
"""Path in an FMU of the manifest, which lists the reference files."""
MANIFEST_ATTRIBUTE_NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"
"""XML namespace of the attributes of the manifest."""
EXPERIMENTS_MIME_TYPE = "application/x-ma-hs-experiments"
"""MIME type of a file of experiments."""
SSV_MIME_TYPE = "application/x-ssp-parameter-set"
"""MIME type of a file of parameter values."""
CSV_MIME_TYPE = "text/csv"
"""MIME type of a file of time series."""
TRANSIENT_SIMULATION_ELEMENT = "TransientSimulation"
"""XML element of the times of an experiment."""
CO_SIMULATION, MODEL_EXCHANGE = FMI_INTERFACE_TYPES = ("co-simulation", "model exchange")
"""Interface types of FMUs."""
INTERFACE_TYPE_LABELS = {name: f"interface:{name.replace(' ', '-')}" for name in FMI_INTERFACE_TYPES}
"""{interface type: label of experiments for it}; experiments without such a label are for all types."""
OUTPUT_SCALES_ANNOTATION_TYPE = "org.jointfmu.scales"
"""Type of the annotation that gives for each output the scale to which its tolerance is relative."""
EXPERIMENT_PURPOSES = ("smoke-test", "validation", "uncertainty-analysis")
"""Purposes of experiments; the first is the default of a manifest."""
MIN_TOLERANCE_SCALE_OVER_NOMINAL = 1e-6
"""Smallest scale of an output over its nominal value [1]: smaller values are dominated by round-off."""
SOLVER_TOLERANCE_OVER_EXPERIMENT_TOLERANCE = 1e-3
"""Relative tolerance of the solver over the tolerance of the experiment [1]: solver errors accumulate, and a
large value can be small after an event."""
