"""Variants of an FMU without compiler: keys of the compiled parts, and agreement of data and code."""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from conftest import RELEASED, Fmu, here_alone, run_host
from joint_cases import CASES, STATE, law, random_inputs
from jointfmu_fmu_src.building import build_fmus
from jointfmu_fmu_src.native.code.generate import generate_sources
from jointfmu_fmu_src.native.compiled import compiled_models
from jointfmu_fmu_src.native.compiled.binary import fill_library_placeholders
from jointfmu_fmu_src.native.compiled.compile_ahead import list_code_structures
from jointfmu_fmu_src.native.data import (
    PLACEHOLDER_FMU_NAME,
    make_data_struct,
    make_fmu_data_struct,
    make_placeholder_data_struct,
    split_parameters,
)
from natives import close
from surroundings import Enter, environment, missing_package
from test_bare import EXTRAS
from test_native_binaries import check_signature, images, members

from jointfmu.joints import KINDS, MODELS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, format_parameter_file, load_default

NAMES = tuple(MODELS)


def of(name: str, changes: dict[str, Any] | None = None) -> tuple[Model, ParameterFile]:
    file = load_default(MODELS[name].joint)
    file = file.with_values(changes or {}, "user", "test")
    return MODELS[name].with_parameters(file.joint, file.values), file


def part_name(model: Model, file: ParameterFile) -> str:
    return compiled_models.make_compiled_model_file_name(model, split_parameters(model, file))


# What a part is kept by


@pytest.mark.parametrize("name", NAMES)
def test_numbers_are_data_and_choices_are_code(name: str) -> None:
    """One compiled part serves all numbers, also those that no tool may set; each choice has its own."""
    model, file = of(name)
    given = split_parameters(model, file)
    assert {*given.variable_names} == {*model.parameter_fields()}
    numbers = {n: v for n, v in file.values_by_name.items() if type(v) is float and v and not v.is_integer()}
    changed = file.with_values({n: v * (1.0 + 1e-6) for n, v in numbers.items()}, "user", "test")
    assert part_name(model, changed) == part_name(model, file)
    every = [part_name(*one) for one in list_code_structures(MODELS[name])]
    assert part_name(model, file) in every
    assert len({*every}) == len(every)


def test_a_part_is_of_the_sources_it_was_made_of(tmp_path: Path) -> None:
    digests = []
    for text in ("K = 1\n", "K = 1\n", "K = 2\n"):
        (tmp_path / "law.py").write_text(text)
        compiled_models._digest_folders.cache_clear()
        digests.append(compiled_models._digest_folders((tmp_path,)))
    assert digests[0] == digests[1] != digests[2]
    compiled_models._digest_folders.cache_clear()


def a_part() -> compiled_models.CompiledModel:
    libraries = {v: {"x86_64-linux": f"library {v}".encode() * 100} for v in compiled_models.FMI_VERSIONS}
    return compiled_models.CompiledModel({"law.c": "int x;\n", "law.h": ""}, libraries)


def test_a_part_is_read_as_it_was_written() -> None:
    content = compiled_models.pack_compiled_model(a_part())
    assert compiled_models.unpack_compiled_model(content) == a_part()
    assert compiled_models.pack_compiled_model(compiled_models.unpack_compiled_model(content)) == content
    for broken in (b"", content[:-40], content[:100], b"x" + content):
        with pytest.raises(
            (OSError, ValueError, EOFError, compiled_models.lzma.LZMAError, compiled_models.tarfile.TarError)
        ):
            compiled_models.unpack_compiled_model(broken)


def test_it_is_compiled_once_and_again_where_the_file_is_broken(tmp_path: Path, enter: Enter) -> None:
    enter(environment(JOINTFMU_CACHE=str(tmp_path)))
    model, file = of("GearContact")
    with here_alone("3"):
        made = compiled_models.get_compiled_model(model, file, split_parameters(model, file))
        (kept,) = tmp_path.rglob("*.tar.xz")
        with missing_package("ziglang"):
            assert compiled_models.get_compiled_model(model, file, split_parameters(model, file)) == made
        kept.write_bytes(kept.read_bytes()[:-40])
        assert compiled_models.get_compiled_model(model, file, split_parameters(model, file)) == made
        with missing_package("ziglang"):
            assert compiled_models.get_compiled_model(model, file, split_parameters(model, file)) == made
    assert [p for p in tmp_path.rglob("*") if p.is_file()] == [kept]


def test_a_cache_that_cannot_be_written_is_no_error(tmp_path: Path, enter: Enter) -> None:
    (tmp_path / "file").write_text("mine")
    enter(environment(JOINTFMU_CACHE=str(tmp_path / "file" / "below")))
    with here_alone("3"):
        (built,) = build_fmus(["GearContact"], ["fmi3"], None, tmp_path / "out")
    assert built.exists()


def test_many_may_keep_the_same_part_at_once(tmp_path: Path) -> None:
    """Old parts are deleted, and no process reads a half-written file."""
    place, content = tmp_path / "new.tar.xz", compiled_models.pack_compiled_model(a_part())
    count = compiled_models.MAX_FILES_PER_CACHE_FOLDER
    for i in range(count + 3):
        old = tmp_path / f"{i}.tar.xz"
        old.write_bytes(b"")
        os.utime(old, (i, i))

    def keep_and_read(_: int) -> compiled_models.CompiledModel:
        compiled_models._write_cache_file(place, content)
        return compiled_models.unpack_compiled_model(place.read_bytes())

    with ThreadPoolExecutor(8) as pool:
        assert set(map(str, pool.map(keep_and_read, range(64)))) == {str(a_part())}
    left = {f"{i}.tar.xz" for i in range(4, count + 3)}
    assert {p.name for p in tmp_path.iterdir()} == {"new.tar.xz", *left}


# What is put in place of the placeholders


def test_a_library_of_other_data_is_refused() -> None:
    before, after = (
        make_data_struct(PLACEHOLDER_FMU_NAME, "", [0.0] * 3),
        make_data_struct("Mine", "{1}", [1.0] * 3),
    )
    library = b"head" + before.struct_bytes + b"tail"
    assert fill_library_placeholders(library, before, after, "Mine") == b"head" + after.struct_bytes + b"tail"
    for other in (b"head", library + before.struct_bytes):
        with pytest.raises(ValueError, match="Mine: the compiled code does not fit these parameters"):
            fill_library_placeholders(other, before, after, "Mine")


PRINTED = """
#include <stdio.h>
#include "data.h"

int main(void)
{
    return fwrite(&data, sizeof data, 1, stdout) == 1 ? 0 : 1;
}
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_table_in_c_has_the_bytes_of_the_binaries(name: str, native: Path, tmp_path: Path) -> None:
    """The bytes agree with the struct that the compiler lays out; no placeholder remains."""
    model, file = of(name)
    files = generate_sources(name, file)
    given = split_parameters(model, file)
    data = make_fmu_data_struct(model, file, given, {k: v for k, v in files.items() if k != "data.c"})
    for part, text in {**files, "print.c": PRINTED}.items():
        (tmp_path / part).write_text(text)
    command = (sys.executable, "-m", "ziglang", "cc", "-std=c11", *RELEASED)
    subprocess.run((*command, "data.c", "print.c", "-o", "print"), cwd=tmp_path, check=True)
    assert subprocess.run([tmp_path / "print"], capture_output=True).stdout == data.struct_bytes
    for version in ("fmi2", "fmi3"):
        for path, content in members(native / version / f"{name}.fmu").items():
            if path.startswith("binaries/"):
                copies = len([*images(content)])
                assert (content.count(data.struct_bytes), copies) == (copies, copies), path
                assert PLACEHOLDER_FMU_NAME.encode() not in content
                assert make_placeholder_data_struct(model, given).struct_bytes not in content


@pytest.mark.slow
def test_each_variant_is_signed_and_has_a_number_of_its_own(tmp_path: Path) -> None:
    import lief

    """macOS loads no other library on arm64, and tells libraries apart by their number."""
    numbers = set()
    for alias, factor in (("First", 1.0), ("Second", 1.1), ("a" * 63, 1.1)):
        model, file = of(NAMES[0])
        name = next(iter(model.parameter_fields()))
        changed = file.with_values({name: factor * file.values_by_name[name]}, "user", "test")
        (path,) = build_fmus([NAMES[0]], ["fmi3"], changed, tmp_path, fmu_alias=alias)
        for member, content in members(path).items():
            if not member.endswith(".dylib"):
                continue
            for image in images(content):
                numbers.add(bytes(image.uuid.uuid))
                (own,) = [c.name for c in image.libraries if "ID" in str(c.command)]
                assert own == f"@rpath/{alias}.dylib"
                if image.has_code_signature:
                    check_signature(content, image.code_signature.data_offset)
            assert lief.MachO.check_layout(lief.MachO.parse(list(content)))[0]
    assert len(numbers) == 3


# Variants


VARIANT = f"""
import sys
sys.modules.update(dict.fromkeys({EXTRAS!r}))
from jointfmu_tools.cli import main
sys.exit(main(["build", sys.argv[1], "--params", sys.argv[2], "--flavour", "fmi3", "--out", sys.argv[3]]
              + sys.argv[4:]))
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", [kind.models[0].name for kind in KINDS.values()])
def test_a_variant_needs_no_compiler(name: str, native: Path, tmp_path: Path) -> None:
    """After the default FMU was built, an installation without compiler builds a variant, with the numbers of
    the package. FMUs of one joint share all fixed contents."""
    kind = KINDS[MODELS[name].joint]
    tuned = ({n: v} for n, v in CASES[name].tuning.tuned.items())
    alone = [one for one in tuned if not list(kind.find_contradictions(of(name, one)[1].values))]
    model, file = of(name, alone[0])
    fixed = {
        n: 0.99 * file.values_by_name[n]
        for n in split_parameters(model, file).data_struct_values
        if n in file.values_by_name
    }
    changed = file.with_values(fixed, "user", "test")
    (tmp_path / "variant.toml").write_text(format_parameter_file(changed))
    begin = os.times()
    done = run_host(VARIANT, name, tmp_path / "variant.toml", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    end = os.times()
    worked = end.children_user + end.children_system - begin.children_user - begin.children_system
    assert worked < 7.0  # 1 s on a quiet machine, 5 s on a busy one; the compiler works for more than 10 s
    instance = Fmu(tmp_path / "out" / "fmi3" / f"{name}.fmu").start(STATE[name])
    expected = law(name, changed.values).after(STATE[name])
    for inputs in random_inputs(name, 5, seed=61):
        assert instance.at(inputs) == close(expected(inputs))
    instance.free_instance()
