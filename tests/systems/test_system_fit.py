"""`jointfmu fit system`: synthetic records of known systems, intervals, refusals, files."""

import json
import re
import shlex
from contextlib import chdir
from pathlib import Path

import numpy as np
import pytest
from jointfmu_tools import cli
from jointfmu_tools.inputs.fitting.least_squares import Unknown, parameter_covariance, solve_least_squares
from jointfmu_tools.systems.fit.compiled_system import CompiledSystem
from jointfmu_tools.systems.fit.correlated_residuals import whiten_jacobian
from jointfmu_tools.systems.fit.estimate import fit_system
from jointfmu_tools.systems.fit.system_text import format_fitted_system
from jointfmu_tools.systems.fmu.assembly import assemble_system
from jointfmu_tools.systems.system import load_system, read_system
from oracles import system_records
from oracles.system_records import CASES, LINEAR, TIME
from scipy.signal import lfilter

import jointfmu
from jointfmu.parameters import read_document

PAGE = Path(__file__).resolve().parents[2] / "docs" / "fitting.md"
HEAD = "time [s],motor.tau_a [N.m],link.phi [deg]\n"
ROWS = "".join(f"{0.1 * k:g},0.1,{k % 2}\n" for k in range(9))


@pytest.mark.parametrize("correlation", [0.0, 0.9])
def test_intervals_hold_with_correlated_residuals(correlation):
    """Of 150 intervals 95 % within four binomial deviations; white noise assumed, 35 % hold at 0.9."""
    random, n, count = np.random.default_rng(0), 300, 50
    x = np.linspace(0.0, 1.0, n)
    basis = np.column_stack([np.sin(40.0 * x), x, np.exp(-3.0 * x)])
    jacobian, held = np.vstack([basis, 2.0 * basis]), 0
    for _ in range(count):
        noise = lfilter([1.0], [1.0, -correlation], random.normal(size=(2, n + 200)))[:, 200:].ravel()
        found = np.linalg.lstsq(jacobian, noise, rcond=None)[0]
        reduced, quantile = whiten_jacobian(jacobian, np.split(noise - jacobian @ found, 2))
        held += np.sum(np.abs(found) < quantile * np.sqrt(np.diag(parameter_covariance(reduced, 1.0))))
    assert held / (3 * count) > 0.95 - 4.0 * np.sqrt(0.95 * 0.05 / (3 * count))


def test_a_parameter_of_any_sign_is_fitted():
    x = np.linspace(-1.0, 1.0, 50)
    unknowns = [Unknown("a", "1", 2.0, 0.0, np.inf), Unknown("b", "m", 0.5, -np.inf, np.inf, 2.0)]
    found = solve_least_squares(unknowns, lambda v: np.sin(v["a"] * x) + v["b"] - np.sin(1.5 * x) + 0.7)
    assert found.values == pytest.approx({"a": 1.5, "b": -0.7}, rel=1e-5)


@pytest.fixture
def record(tmp_path):
    system_records.write_system(tmp_path, LINEAR)
    (tmp_path / "record.csv").write_text(HEAD + ROWS)
    return tmp_path / "record.csv"


@pytest.mark.parametrize(
    ("text", "options", "refusal"),
    [
        ("", "--free link.j", "'link.j' is no parameter of arm, nearest are link.J"),
        ("", "--free link.J link.J", "parameter 'link.J' is given twice"),
        ("", "--free link.lag_a", "link.lag_a is fixed in the compiled system; allowed are link.J,"),
        (
            "",
            "--free drive.hysteresis_loss",
            "hysteresis_loss = 0 rad cannot be the start value .* in the system file",
        ),
        ("", "--free link.J --hold-out 1", r"hold_out = 1 is outside \[0, 0.9\]: share of the record"),
        ("", "--free link.J --columns link.q=x", "--columns 'link.q=x': expected NAME=HEADING, with a "),
        ("", "--free link.J --out a-b.toml", "name 'a-b' is not a model identifier"),
        (
            HEAD.replace("link.phi", "link.phj") + ROWS,
            "--free link.J",
            "'link.phj' is no variable .* link.phi",
        ),
        (HEAD.replace(" [deg]", "") + ROWS, "--free link.J", "column 'link.phi' has no unit"),
        (
            HEAD.replace("deg", "N") + ROWS,
            "--free link.J",
            "column 'link.phi' has unit 'N', allowed are rad, deg",
        ),
        (
            HEAD.replace("link.phi [deg]", "q [deg]") + ROWS,
            "--free link.J",
            r"no column to compare \(motor.tau_a\)",
        ),
        (HEAD + ROWS + "0.8,0,1\n", "--free link.J", "line 11: time = 0.8 s is not after 0.8 s of line 10"),
        (HEAD + ROWS.replace(",0.1,1\n", ",0.1,0\n"), "--free link.J", "link.phi is 0 in every row"),
        (
            HEAD + ROWS.replace(",0.1,0\n", ",0.1,2\n"),
            "--free link.J",
            "link.phi starts at 0.0349.*add link.phi",
        ),
        (HEAD + "0,0,0\n", "--free link.J", "has 1 rows of numbers, at least 8 are needed"),
    ],
)
def test_wrong_input_is_one_line(record, text, options, refusal, capsys):
    if text:
        record.write_text(text)
    words = ["fit", "system", str(record.with_name("arm.toml")), str(record), *shlex.split(options)]
    assert cli.main(words) == 2
    assert re.search(refusal, capsys.readouterr().err.strip())


def test_the_written_system_has_the_fitted_values(tmp_path):
    """In nested sections too; parameter files are found from the new folder."""
    (tmp_path / "start").mkdir()
    path = system_records.write_system(tmp_path / "start", LINEAR)
    model = assemble_system(load_system("robot_joint"))
    values = {"link.J": 0.5, "drive.surface.G": 2e-9}
    fitted = model.make_system_parameter_file(model.make_fmu_model()).with_values(
        values, "measured", "fitted to x.csv"
    )
    units = {"link.J": "kg.m2", "drive.surface.G": "m", "link.phi": "rad"}
    written = tmp_path / "new.toml"
    written.write_text(format_fitted_system(path, fitted, units, written))
    document = read_document(written, "a system")
    assert document["drive"]["parameters"] == "start/arm_drive.toml"
    entry = {"value": 0.5, "unit": "kg.m2", "kind": "measured", "source": "fitted to x.csv"}
    assert document["link"] == {"model": "RotationalInertia", "J": entry}
    assert document["drive"]["surface"]["G"]["value"] == 2e-9
    assert document["drive"]["d"] == read_document(path, "a system")["drive"]["d"]


@pytest.mark.slow  # compiles the system
class TestFits:
    def test_the_engine_moves_as_scipy_says(self, tmp_path):
        compiled = CompiledSystem(assemble_system(read_system(system_records.write_system(tmp_path, LINEAR))))
        torque = system_records.make_torque(TIME, 0.05)
        due = system_records.move_linear_system(TIME, torque)
        found = compiled.simulate({}, TIME, {"motor.tau_a": torque}, [*due])
        for column, angle in zip(found.T, due.values(), strict=True):
            assert np.abs(column - angle).max() < 1e-7 * np.ptp(angle)

    @pytest.mark.parametrize("name", CASES)
    def test_parameters_are_found_from_thirty_per_cent_off(self, name, tmp_path):
        """Within four deviations (half an interval is two); the held-out part within twice the noise."""
        fit, truth = system_records.fit_case(name, 1, tmp_path, 0.2), CASES[name][1]
        assert fit.rejection_reason() is None
        for u in fit.solution.unknowns:
            low, high = map(u.to_search_variable, fit.confidence_intervals[u.parameter_name])
            assert abs(u.to_search_variable(truth[u.parameter_name]) - 0.5 * (low + high)) < high - low
            assert high - low < 0.1
        for column in {name for name in fit.facts if name.startswith("residual.")}:
            held_out = fit.facts[column.replace("residual.", "held_out.")][0]
            assert held_out < 2.0 * fit.facts[column][0]

    def test_intervals_hold_the_truth(self, tmp_path):
        """Of 32 intervals 30.4 due; below 26 with a probability of 1 %. A study counts 400."""
        name = next(iter(CASES))
        fits = [system_records.fit_case(name, seed, tmp_path) for seed in range(8)]
        held = sum(sum(system_records.count_held(fit, LINEAR).values()) for fit in fits)
        assert held >= 26

    def test_what_a_ring_down_does_not_determine(self, tmp_path):
        """Ratios of stiffness, inertia and damping alone, while the motion stays in the linear part."""
        path, record = system_records.make_ring_down(tmp_path, 1, 3e-4)
        fit = fit_system(read_system(path), record, ["link.J", "drive.K1", "drive.d", "link.phi"])
        (line,) = [text for text in fit.warnings() if text.startswith("the data do not determine")]
        assert line.removeprefix("the data do not determine ").startswith("link.J, drive.K1, drive.d:")
        assert any("combination link.J^-1 drive.K1 is determined" in text for text in fit.warnings())
        with pytest.raises(ValueError, match=r"drive.T2 = 40 N.m has no effect on link.phi; fit other"):
            fit_system(read_system(path), record, ["drive.T2", "link.phi"])

    def test_the_command_prints_what_its_page_says(self, tmp_path, enter, capsys):
        enter(chdir(tmp_path))
        system_records.make_chirp_record(tmp_path, 1)
        command = re.search(r"\njointfmu (fit system arm.*)\n", PAGE.read_text(encoding="utf-8"))
        assert cli.main(shlex.split(command[1])) == 0
        printed = capsys.readouterr().out
        due = PAGE.read_text(encoding="utf-8").partition(command[0])[2].partition("```text\n")[2]
        number = r"\d[\d.]*(?:e[-+]\d+)?"
        for line, expected in zip(printed.splitlines(), due.partition("```")[0].splitlines(), strict=True):
            assert re.sub(number, "0", line) == re.sub(number, "0", expected)
            found, stated = (np.array(re.findall(number, text), float) for text in (line, expected))
            np.testing.assert_allclose(found, stated, rtol=5e-4)
        fitted = read_system(tmp_path / "fitted_arm.toml")
        values = fitted.stated_values
        assert values["link.J"] == pytest.approx(LINEAR["link.J"], rel=0.01)
        assert fitted.components["drive"].value_sources["d"].startswith("fitted to record.csv, ")

    def test_a_system_that_cannot_follow_is_not_written(self, tmp_path, capsys):
        path, record = system_records.make_chirp_record(tmp_path, 1)
        table = np.loadtxt(record, delimiter=",", skiprows=1)
        table[:, 2:] = np.random.default_rng(1).normal(size=table[:, 2:].shape)
        table[0, 2:] = 0.0
        np.savetxt(record, table, delimiter=",", comments="", header=record.read_text().partition("\n")[0])
        out = tmp_path / "fitted.toml"
        words = ["fit", "system", str(path), str(record), "--free", "motor.J", "--out", str(out), "--json"]
        assert cli.main(words) == 1
        assert "misses every measured column" in json.loads(capsys.readouterr().out)["doubt"]
        assert not out.exists()

    def test_in_python(self, tmp_path):
        path, record = system_records.make_chirp_record(tmp_path, 1)
        fit = jointfmu.fit_system(path, record, "link.J")
        assert "link.J" in str(fit)
        assert (
            read_system(fit.save(tmp_path / "saved.toml")).stated_values["link.J"]
            == fit.outcome.solution.values["link.J"]
        )
