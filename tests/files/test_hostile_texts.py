"""Texts of parameter files that look like code: writers escape them; control characters are refused."""

import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from conftest import RELEASED, refused_line
from jointfmu_fmu_src.joint_parts.c_text import escape_c_comment, format_string_literal
from jointfmu_fmu_src.native.data import make_data_struct
from jointfmu_fmu_src.native.page import make_documentation
from jointfmu_fmu_src.ssv import ParameterValue, format_ssv_parameter_set
from jointfmu_fmu_src.xml_parts import format_xml_comment as xml_comment
from jointfmu_tools.exchange.export import writing
from jointfmu_tools.exchange.export.target_model import SI_UNIT_SET
from jointfmu_tools.exchange.modelica.library import render_library, render_system
from jointfmu_tools.exchange.robots import urdf
from jointfmu_tools.exchange.robots.names import make_identifier
from jointfmu_tools.joints.harmonic_drive.transmission import make_transmission
from jointfmu_tools.pages.report.joint import write_joint_report
from jointfmu_tools.systems.system import read_system

from jointfmu.files.text import MAX_NAME_LENGTH, MAX_TEXT_LENGTH
from jointfmu.joints import KINDS, MODELS
from jointfmu.parameters import ParameterFile, format_parameter_file, load_default, load_parameter_file

ROOT = Path(__file__).resolve().parents[2]
DRIVE = "harmonic_drive"
FMU = KINDS[DRIVE].models[0].name
TEXTS = (
    '*/ __attribute__((constructor)) static void run(void) { printf("run"); } /*',
    "*??/ / int broken; /*",
    '"""); import os; """',
    "ends with a backslash \\",
    'quote " and \\" and \' and `',
    "<script>alert(1)</script>",
    "</script><script>alert(1)</script>",
    '"><img src=x onerror=alert(1)>',
    '</html>"); end X; model Y "<html>',
    "]]><!-- --> ---- --",
    "<?xml version='1.0'?><!DOCTYPE x>&lt;&x;",
    "trigraph ??/ ??' ??( ??-",
    "{{ 7 * 7 }} {% raw %} << 7 * 7 >> <% x %>",
    "$(touch x) `touch x`; touch x | %PATH%",
    "equation",
    "end",
    "Ünïcode 轴 😀",
)
CONTROLS = ("\0", "\x1b[31m", "\n", "\r", "\t", "\x7f", "\x85", "\u2028", "\u202e", "\ufffe")


def hostile(text: str, joint: str = DRIVE) -> ParameterFile:
    """Default parameters of a joint with this text as name and as every source."""
    file = load_default(joint)
    return replace(file, name=text, sources=dict.fromkeys(file.sources, text))


class Tags(HTMLParser):
    """Parser that collects tags, attribute names and text of a page."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: list[tuple[str, tuple[str, ...]]] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, tuple(name for name, _ in attrs)))

    def handle_endtag(self, tag: str) -> None:
        self.found.append((f"/{tag}", ()))


def test_c_compiles_without_warning_and_runs_nothing(tmp_path: Path) -> None:
    data = make_data_struct("Name", "token", [0.0])
    heads = [data.make_c_source(f" from the parameters {text!r}").split("\n")[0] for text in TEXTS]
    heads += [
        data.make_c_source(f" from {text}{end}*/ int x;").split("\n")[0] for text in TEXTS for end in "\0\n\\"
    ]
    bytes_of = ["{" + ", ".join(f"0x{byte:02x}" for byte in text.encode()) + ", 0}" for text in TEXTS]
    checks = [
        f"{{ const unsigned char meant[] = {meant}; const char written[] = {format_string_literal(text)};\n"
        '_Static_assert(sizeof meant == sizeof written, "length");\n'
        "if (memcmp(meant, written, sizeof meant)) return 1; }"
        for text, meant in zip(TEXTS, bytes_of, strict=True)
    ]
    lines = [
        "#include <stdio.h>",
        "#include <string.h>",
        *heads,
        "int main(void) {",
        *checks,
        "return 0; }",
        "",
    ]
    (tmp_path / "main.c").write_text("\n".join(lines), encoding="utf-8")
    (tmp_path / "data.h").write_text(data.make_c_header())
    options = ["-std=c11", "-Wall", "-Wextra", "-Werror", "-Wtrigraphs", "-Wcomment", "main.c", "-o", "main"]
    command = [sys.executable, "-m", "ziglang", "cc", *RELEASED, *options]
    subprocess.run(command, cwd=tmp_path, check=True, timeout=300)
    done = subprocess.run([tmp_path / "main"], capture_output=True, check=True, timeout=60)
    assert done.stdout == b""


def test_a_comment_of_c_neither_ends_nor_begins() -> None:
    for text in (*TEXTS, "*//**/*/", "//**//"):
        assert "*/" not in escape_c_comment(text)
        assert "/*" not in escape_c_comment(text)
        assert "??" not in escape_c_comment(text)


@pytest.mark.parametrize("text", TEXTS)
def test_toml_gives_the_text_back(text: str, tmp_path: Path) -> None:
    path = tmp_path / "file.toml"
    path.write_text(format_parameter_file(hostile(text)), encoding="utf-8")
    assert load_parameter_file(path).name == text
    assert set(load_parameter_file(path).sources.values()) == {text}


@pytest.mark.parametrize("text", TEXTS)
def test_xml_is_well_formed_and_holds_the_text(text: str) -> None:
    root = ElementTree.fromstring(format_ssv_parameter_set(text, {"a": ParameterValue(1.0, "m", text)}))
    assert root.get("name") == text
    assert root[0][0].get("description") == text
    lines = [text, f"{text}-", "---"]
    assert len(ElementTree.fromstring(f"<?xml version='1.0'?>{xml_comment(lines)}<a/>")) == 0


@pytest.mark.parametrize("first", range(0, len(TEXTS), 4))
def test_a_robot_in_urdf_has_any_name(first: int) -> None:
    text = " ".join(TEXTS[first : first + 4])
    robot, _, _ = urdf.format_urdf(make_transmission(hostile(text)), 10.0)
    assert ElementTree.fromstring(robot).get("name") == text


@pytest.mark.parametrize("joint", KINDS)
def test_documentation_pages_have_the_elements_of_any_name(joint: str) -> None:
    model = KINDS[joint].models[0]

    def elements(text: str) -> Any:
        file = hostile(text, joint)
        return Tags(
            make_documentation(model.with_parameters(joint, file.values), file)["index.html"].decode()
        ).found

    assert elements(" ".join(TEXTS[5:9])) == elements("plain")


def test_reports_have_the_elements_of_any_name(tmp_path: Path) -> None:
    pages = [tmp_path / "hostile.html", tmp_path / "plain.html"]
    for path, text in zip(pages, (" ".join(TEXTS[5:9]), "plain"), strict=True):
        write_joint_report(path, hostile(text))
    one, other = (Tags(path.read_text(encoding="utf-8")).found for path in pages)
    assert one == other


@pytest.fixture(scope="module")
def plain_library() -> Mapping[str, str]:
    return render_library(hostile("plain"))


@pytest.mark.parametrize("text", [" ".join(TEXTS[2:5]), " ".join(TEXTS[5:9]), *TEXTS[3:4]])
def test_modelica_reads_the_text_as_text(text: str, plain_library: Mapping[str, str]) -> None:
    """No text becomes a tag of the documentation, and rumoca can parse every class that contains it."""
    import rumoca

    plain, written = plain_library, render_library(hostile(text))
    assert len(written) == len(plain)
    changed = {path: content for path, content in written.items() if plain.get(path) != content}
    assert changed
    for path, content in changed.items():
        if path.endswith(".mo"):
            info = content[content.rindex('info="') :]
            assert "<script" not in info
            assert "<img" not in info
            rumoca.format(content, filename=path)  # raises where it cannot be parsed


def test_a_system_in_modelica_reads_the_text_as_text(tmp_path: Path) -> None:
    import rumoca

    text = (ROOT / "models/systems/robot_joint.toml").read_text(encoding="utf-8")
    everything = " ".join(TEXTS).replace("\\", "\\\\").replace('"', '\\"')
    for key in ("name", "description"):
        start = text.index(f"\n{key} = ")
        shown = everything[:150].rstrip("\\") if key == "name" else everything
        text = text[:start] + f'\n{key} = "{shown}"' + text[text.index("\n", start + 1) :]
    text = text.replace('source = "rotor of', f'source = "{everything}')
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    written = render_system(read_system(path))
    rumoca.format(written, filename="Mine.mo")  # raises where it cannot be parsed
    info = written[written.rindex('info="') :]
    assert "<script" not in info
    assert "<img" not in info


@pytest.mark.parametrize("form", ["csv", "modelica"])
def test_decks_keep_the_text_in_their_comment(form: str) -> None:
    plain, *found = (
        writing.export_curve(form, hostile(name), None, SI_UNIT_SET, 1e-3).file_text.splitlines()
        for name in ("plain", TEXTS[3], *(" ".join(TEXTS[i::4]) for i in range(4)))
    )
    for lines in found:
        assert len(lines) == len(plain)
        assert all(a == b or a.startswith("#") for a, b in zip(lines, plain, strict=True))


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("place", ["name", "source", "key", "unit"])
def test_control_characters_are_refused_when_a_file_is_read(
    control: str, place: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    escaped = "".join(f"\\u{ord(c):04X}" for c in control[0]) + control[1:]
    text = format_parameter_file(hostile("plain"))
    text = {
        "name": text.replace('name = "plain"', f'name = "a{escaped}b"', 1),
        "source": text.replace('source = "plain"', f'source = "a{escaped}b"', 1),
        "unit": text.replace('unit = "', f'unit = "{escaped}', 1),
        "key": f'{text}\n["a{escaped}b"]\nc = 1\n',
    }[place]
    (tmp_path / "file.toml").write_text(text, encoding="utf-8")
    line = refused_line(capsys, "report", tmp_path / "file.toml", "--out", tmp_path / "out.html")
    assert f"has the control character U+{ord(control[0]):04X}" in line
    assert control not in line.rstrip("\n")


@pytest.mark.parametrize("key", ["name", "description", "load.ramp_start.source"])
def test_control_characters_are_refused_when_a_system_is_read(
    key: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (ROOT / "models/systems/robot_joint.toml").read_text(encoding="utf-8")
    old = {"name": '"Robot joint', "description": '"Motor, ', "load.ramp_start.source": '"the system rests'}[
        key
    ]
    assert old in text
    (tmp_path / "mine.toml").write_text(text.replace(old, f"{old}\\u001b", 1), encoding="utf-8")
    line = refused_line(capsys, "system", tmp_path / "mine.toml", "--out", tmp_path / "out")
    assert f"{key} has the control character U+001B" in line


@pytest.mark.parametrize("control", CONTROLS)
def test_control_characters_are_refused_in_python(control: str) -> None:
    with pytest.raises(ValueError, match="control character"):
        hostile(f"a{control}b")


def test_long_texts_are_refused_at_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, text = tmp_path / "file.toml", format_parameter_file(hostile("plain"))
    for what, most in (("name", MAX_NAME_LENGTH), ("source", MAX_TEXT_LENGTH)):
        for length, refused in ((most, False), (most + 1, True), (1_000_000, True)):
            path.write_text(
                text.replace(f'{what} = "plain"', f'{what} = "{"a" * length}"', 1), encoding="utf-8"
            )
            if not refused:
                assert load_parameter_file(path)
                continue
            begin = time.perf_counter()
            line = refused_line(capsys, "report", path, "--out", tmp_path / "out.html")
            assert f"{what} has {length} characters; allowed are at most {most}" in line
            assert len(line) < 500
            assert time.perf_counter() - begin < 5.0


@pytest.mark.parametrize(
    "name", ["equation", "end", "time", "within", "CON", "nul", "Com1", "LPT9", "class", "int"]
)
def test_reserved_words_name_neither_fmus_nor_components(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = refused_line(capsys, "build", FMU, f"--name={name}", "--out", tmp_path / "out")
    assert "is not a model identifier" in line
    text = (ROOT / "models/systems/robot_joint.toml").read_text(encoding="utf-8")
    text = text.replace("[drive]", f"[{name}]").replace("drive.flange", f"{name}.flange")
    for file, content in (("mine", text), (name, (ROOT / "models/systems/robot_joint.toml").read_text())):
        (tmp_path / f"{file}.toml").write_text(content, encoding="utf-8")
        line = refused_line(capsys, "system", tmp_path / f"{file}.toml", "--out", tmp_path / "out")
        assert "no device of Windows" in line
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["CON", "nul", "end", "int"])
def test_files_of_drives_and_classes_are_never_named_by_reserved_words(name: str) -> None:
    assert make_identifier(name) == f"_{name}"
    written = render_library(hostile(name))
    assert f"Data/Joint_{name}.mo" in written


@pytest.mark.parametrize("name", [model for model in MODELS if model in {"GearMesh", "GearContact"}])
def test_a_record_never_replaces_a_class_of_the_library(name: str) -> None:
    with pytest.raises(ValueError, match=f"the library has a class {name}"):
        render_library(hostile(name, MODELS[name].joint))
