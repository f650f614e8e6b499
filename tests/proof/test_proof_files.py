"""Files of FMI-LS-REF in FMUs: schemas, references, boundary values, text."""

import io
import math
import re
import zipfile
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from joint_cases import NAMES, law, parameters
from jointfmu_fmu_src.partners import PARTNERS
from jointfmu_fmu_src.partners import load_partner_parameters as partner_parameters
from jointfmu_fmu_src.partners.laws import GRAVITY
from jointfmu_fmu_src.proof import standard
from jointfmu_fmu_src.proof.experiments import (
    ReferenceExperiment,
    list_shipped_variants,
    make_uncertainty_study,
)
from jointfmu_fmu_src.proof.files import REFERENCE_TOLERANCE
from jointfmu_fmu_src.proof.members import get_reference_experiments, make_proof_files
from jointfmu_fmu_src.proof.reference import Stimulus, compute_reference_results
from jointfmu_fmu_src.proof.series import TimeSeries, format_time_series_csv, parse_time_series_csv
from jointfmu_tools.run.proof import manifest
from jointfmu_tools.studies.uncertainty import study as study_files
from lxml import etree

from jointfmu.joints import KINDS, MODELS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, load_default, load_parameter_file
from jointfmu.quantity import replace_values

SCHEMAS = Path(str(files("fmpy") / "schema" / "fmi3"))
EVERY = [*NAMES, *PARTNERS]
pytestmark = pytest.mark.slow  # each joint is tabulated some forty times


@cache
def given(name: str) -> tuple[Model, ParameterFile]:
    file = load_default(MODELS[name].joint) if name in MODELS else partner_parameters(name)
    return (MODELS | PARTNERS)[name].with_parameters(file.joint, file.values), file


@cache
def made(name: str) -> tuple[ReferenceExperiment, ...]:
    return get_reference_experiments(*given(name))


@cache
def members(name: str) -> dict[str, bytes]:
    return make_proof_files(*given(name))


class Local(etree.Resolver):
    """Resolver of the schemas that another schema names by address, from the files of fmpy."""

    def resolve(self, address: str, public: Any, context: Any) -> Any:
        return self.resolve_filename(str(SCHEMAS / Path(address).name), context)


@cache
def schema(path: Path) -> etree.XMLSchema:
    parser = etree.XMLParser()
    parser.resolvers.add(Local())
    return etree.XMLSchema(etree.parse(str(path), parser))


@pytest.mark.parametrize("name", EVERY)
def test_the_manifest_is_valid_and_all_that_it_names_is_there(name: str) -> None:
    own = Path(__file__).parent / "standards" / "fmi3LayeredStandardReferenceManifest.xsd"
    data = members(name)[standard.MANIFEST_PATH]
    schema(own).assertValid(etree.fromstring(data))
    below = {path.removeprefix(f"{standard.REFERENCE_FILE_FOLDER}/") for path in members(name)}
    named = [related.get("source", "") for related in ElementTree.fromstring(data)]
    outside = {"../../documentation/index.html", "../../documentation/fmi-ls-ref.txt"}
    assert set(named) - outside <= below
    assert outside <= set(named)
    experiments = [path for path in named if path.endswith(".exp")]
    assert experiments == ["smoke-test.exp", "validation.exp", "uncertainty-analysis.exp"]
    used = {
        child.get("source")
        for path in experiments
        for child in ElementTree.fromstring(members(name)[f"{standard.REFERENCE_FILE_FOLDER}/{path}"]).iter()
    }
    assert {path for path in below if path.startswith("experiments/")} <= used


@pytest.mark.parametrize("name", EVERY)
def test_parameter_sets_are_valid_and_have_every_parameter(name: str) -> None:
    path = Path(fmpy.__file__).parent / "ssp" / "schema" / "SystemStructureParameterValues.xsd"
    sets = {path: data for path, data in members(name).items() if path.endswith(".ssv")}
    for data in sets.values():
        schema(path).assertValid(etree.fromstring(data))
    model, _ = given(name)
    exposed = model.parameter_fields().keys()
    for path in (p for p in sets if "/parameters/" in p):
        nodes = ElementTree.fromstring(sets[path]).iter(f"{{{manifest.SSV_NAMESPACE}}}Parameter")
        assert {node.get("name") for node in nodes} == exposed


@pytest.mark.parametrize("name", EVERY)
def test_every_experiment_states_times_and_tolerance(name: str) -> None:
    for purpose in standard.EXPERIMENT_PURPOSES:
        root = ElementTree.fromstring(members(name)[f"{standard.REFERENCE_FILE_FOLDER}/{purpose}.exp"])
        for one in root.iter("Experiment"):
            assert one[0].tag == "TransientSimulation"
            assert float(one.get("tolerance", "nan")) == REFERENCE_TOLERANCE
            assert {"startTime", "stopTime", "stepSize"} == one[0].attrib.keys()


@pytest.mark.parametrize("name", NAMES)
def test_references_are_those_of_the_joint_itself(name: str) -> None:
    """References are computed by functions of the joint that the builders do not call."""
    model, file = given(name)
    ramp = next(one for one in made(name) if one.experiment_name == "load ramp")
    joint = law(name, parameters(name))
    rest = {v.name: file.start_value(v.name) for v in model.inputs}
    end = model.with_load_range(joint.spring, rest).ramp.end_value
    assert ramp.input_stimulus.input_levels[-1] == pytest.approx(end, rel=1e-8)
    for i in (5, 20):
        expected = joint(rest | {model.ramp.input_name: float(ramp.input_stimulus.input_levels[i])})
        for output, value in expected.items():
            # memory takes the way in steps: friction is the same, its work is summed otherwise
            assert ramp.reference_results.columns[output][i] == pytest.approx(value, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("name", [name for name in NAMES if MODELS[name].advance])
def test_the_loop_shows_memory(name: str) -> None:
    """At the same input, outputs on loading and unloading differ by far more than the tolerance."""
    loop = next(one for one in made(name) if one.experiment_name == "loop")
    levels = loop.input_stimulus.input_levels
    first, second = (i for i in range(1, levels.size - 1) if levels[i] == levels[0])
    apart = [
        abs(column[first] - column[second]) / np.max(np.abs(column))
        for column in loop.reference_results.columns.values()
        if np.any(column)
    ]
    assert max(apart) > 1e3 * REFERENCE_TOLERANCE


def test_every_joint_with_memory_has_a_loop() -> None:
    assert [m.name for m in MODELS.values() if m.advance and not m.load_cycle] == []


@pytest.mark.parametrize("name", EVERY)
def test_neighbours_lie_just_inside_what_is_refused(name: str) -> None:
    """The next value towards the end of the interval is refused, by the interval or by the joint."""
    model, file = given(name)
    found = [one for one in made(name) if one.experiment_description.startswith("inside ")]
    assert found or name in PARTNERS  # whose numbers may have no end
    for one in found:
        usual = {
            model.ramp.input_name: model.ramp.end_value,
            **model.ramp.parameter_values,
        }  # what drives states, and a course
        ((parameter, value),) = one.variable_values.items() - usual.items()
        interval = model.parameter_fields()[parameter].metadata["interval"]
        own = file.values_by_name[parameter]
        end = interval.low if value < own else interval.high
        assert interval.contains(value)
        further = end + math.copysign(1e-9, end - own) if value == end else 0.1 * value + 0.9 * end
        if abs(value - end) <= 1e-5 * max(abs(own - end), 1.0):  # a factor of 10 beyond what they are
            further = end + math.copysign(1e-9, end - own)
        if model.parameter_fields()[parameter].metadata["whole"]:
            further = value + math.copysign(1.0, end - own)
        with pytest.raises((ValueError, RuntimeError, ArithmeticError)):
            compute_reference_results(
                model,
                replace_values(file.values, {parameter: further}),
                {v.name: file.start_value(v.name) for v in model.inputs},
                Stimulus(model.ramp.input_name, np.array([0.0, model.ramp.end_value]), 1.0),
            )


@pytest.mark.parametrize("name", NAMES)
def test_shipped_models_of_the_same_structure_are_carried(name: str) -> None:
    model, file = given(name)
    carried = list_shipped_variants(model, file)
    assert carried[0] == (file, {})
    folder = KINDS[model.joint].default_file().parent
    same = [
        load_parameter_file(path)
        for path in (*folder.glob("*.toml"), *folder.parent.glob("catalogue/*.toml"))
    ]
    assert {one.name for one, _ in carried} <= {one.name for one in same}
    assert {one.law for one, _ in carried} == {file.law}


def test_one_shipped_model_at_least_is_carried_by_the_fmu_of_another() -> None:
    assert any(len(list_shipped_variants(*given(name))) > 1 for name in NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_the_uncertainty_experiment_can_be_read_as_a_study(name: str, tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_bytes(members(name)[f"{standard.REFERENCE_FILE_FOLDER}/parameters/study.toml"])
    assert study_files.read_study(path) == make_uncertainty_study(*given(name))
    samples = [one for one in made(name) if one.experiment_purpose == "uncertainty-analysis"]
    assert len(samples) == 6
    for one in samples:
        for parameter, value in one.variable_values.items():
            assert abs(value / given(name)[1].values_by_name[parameter] - 1.0) <= 0.01 * (1.0 + 1e-9)
    assert len({tuple(one.variable_values.values()) for one in samples}) == 6


def test_the_sources_of_parameters_can_be_built_from(tmp_path: Path) -> None:
    name = NAMES[0]
    (path,) = (p for p in members(name) if p.endswith(".toml") and "study" not in p)
    (tmp_path / "own.toml").write_bytes(members(name)[path])
    assert load_parameter_file(tmp_path / "own.toml").values_by_name == given(name)[1].values_by_name


@pytest.mark.parametrize("name", EVERY)
def test_it_is_small(name: str) -> None:
    """The proof takes less than 50 kB packed, a tenth of an FMU, and less than 120 kB unpacked."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for path, content in members(name).items():
            archive.writestr(path, content)
    assert file.tell() < 50e3
    assert sum(map(len, members(name).values())) < 120e3


@pytest.mark.parametrize("name", EVERY)
def test_the_text_says_how_many_and_how_near(name: str) -> None:
    said = members(name)["documentation/fmi-ls-ref.txt"].decode()
    counts = re.findall(r"^ +(\d+) [a-z-]+$", said, re.MULTILINE)
    assert sum(map(int, counts)) == len(made(name))
    assert f"{REFERENCE_TOLERANCE:g} max(|reference|" in said


@pytest.mark.parametrize("name", ["TorqueProfile", "ForceProfile", "AngleProfile"])
def test_a_course_over_time_shows_itself_in_its_proof_alone(name: str) -> None:
    """The experiments of a load over time show its shape, although the default file has heights of zero."""
    model, file = given(name)
    assert not any(value for key, value in file.values_by_name.items() if key.endswith("height"))
    one = made(name)[1]
    column = one.reference_results.columns[model.outputs[0].name]
    assert np.max(np.abs(column - np.linspace(0.0, column[-1], column.size))) > 1e-9 * column[-1]


def test_a_mass_under_a_constant_force_moves_as_newton_says() -> None:
    model, file = given("TranslationalMass")
    one = made("TranslationalMass")[1]
    t, f = one.input_stimulus.sampling_instants, one.variable_values[model.ramp.input_name]
    a = f / file.values.m
    for output, expected in (("s", 0.5 * a * t**2), ("v", a * t), ("a", a + 0.0 * t)):
        assert one.reference_results.columns[output] == pytest.approx(expected, rel=1e-11)


def test_a_weight_keeps_its_energy() -> None:
    """Integration of states: kinetic and potential energy against the work of the torque."""
    model, file = given("RotationalInertia")
    values = replace_values(file.values, {"m": 2.0, "l": 0.3})
    drive = Stimulus("tau_a", np.full(21, 1.0), 0.05)
    found = compute_reference_results(model, values, {v.name: 0.0 for v in model.inputs}, drive).columns
    potential = 2.0 * GRAVITY * 0.3 * (1.0 - np.cos(found["phi"]))
    energy = 0.5 * file.values.J * found["w"] ** 2 + potential
    assert energy == pytest.approx(found["phi"], rel=1e-9, abs=1e-12)
    assert np.max(np.abs(found["phi"])) > 0.1


# Series


def test_series_are_written_and_read_alike() -> None:
    series = TimeSeries(
        np.array([0.0, 0.5, 1.0]), {"a": np.array([0.0, -0.0, 1.0 / 3.0]), "b.c": np.arange(3.0)}
    )
    written = format_time_series_csv(series)
    assert written.splitlines()[0] == '"time","a","b.c"'
    back = parse_time_series_csv(written, "x")
    assert back.time.tolist() == [0.0, 0.5, 1.0]
    assert {name: column.tolist() for name, column in back.columns.items()} == {
        name: column.tolist() for name, column in series.columns.items()
    }
    assert format_time_series_csv(series, 3).splitlines()[-1] == "1.0,0.333,2"


def test_a_jump_is_taken_where_it_stands() -> None:
    series = parse_time_series_csv("time,u\n0,0\n1,1\n1,5\n2,6\n", "x")
    times = np.array([0.5, 1.0, 1.5, 3.0])
    assert series.interpolate_linearly("u", times).tolist() == [0.5, 5.0, 5.5, 6.0]
    assert series.interpolate_before_jumps("u", times).tolist() == [0.5, 1.0, 5.5, 6.0]
    assert series.interpolate_stepwise("u", times).tolist() == [0.0, 5.0, 5.0, 6.0]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "is empty; expected columns, 'time' first"),
        ("u,time\n0,0\n", "the first column is 'u', expected 'time'"),
        ("time,u\n", "no rows below its header"),
        ("time,u,u\n0,1,2\n", "column 'u' is given twice"),
        ("time,u\n0,1\n1\n", "row 2 below the header has 1 numbers, expected 2"),
        ("time,u\n0,one\n", "'one'; expected a number for each column"),
        ("time,u\n1,1\n0,1\n", "row 2: time = 0 s; expected finite times that never decrease"),
        ("time,u\nnan,1\n", "row 1: time = nan s; expected finite times"),
    ],
)
def test_a_broken_series_is_refused(content: str, said: str) -> None:
    with pytest.raises(ValueError, match=f"^x: .*{re.escape(said)}"):
        parse_time_series_csv(content, "x")
