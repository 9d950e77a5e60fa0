"""Make a real ROS 2 (Kilted) in `build/ros2`: rclpy from PyPI's wheels, and rmw_zenoh_cpp built from its source.

    tests/campaign/ros2/prepare.py [DIRECTORY]

It takes a minute, Python 3.11, git and g++, on Linux on x86_64. No wheel has zenoh-c; the extension module of
rainbow-rb-zenoh exports all of its C symbols, of the version that rmw_zenoh_cpp wants. It is a stranger's binary: good
for a test, and for nothing else. Shared memory, which that module lacks, is cut out of the source.
"""

import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

HERE: Final = Path(__file__).parents[3] / "build" / "ros2"
ROS: Final = (
    *("ros-rclpy[fastrtps]==9.1.2", "ros-std-srvs==5.5.1", "ros-nav-msgs==5.5.1", "ros-sensor-msgs==5.5.1"),
    *("ros-geometry-msgs==5.5.1", "ros-diagnostic-msgs==5.5.1"),
)
ZENOH_C_SYMBOLS: Final = "rainbow-rb-zenoh==0.10.3"


class Source(NamedTuple):
    """A repository at a fixed commit."""

    repository: str
    commit: str
    branch: str
    """Where the commit is."""
    path: str
    """Part that is needed."""


SOURCES: Final = {
    "rmw": Source(
        "https://github.com/ros2-gbp/rmw_zenoh-release",
        "70c38f56ca02ce69042a302efd618e5c0fa9b251",
        "release/kilted/rmw_zenoh_cpp",
        ".",
    ),
    "c": Source("https://github.com/eclipse-zenoh/zenoh-c", "67f59fce216a32dbe79a6b02a6445444e49a8557", "", "."),
    "cpp": Source(
        "https://github.com/eclipse-zenoh/zenoh-cpp", "af381b420cc8837ac7da42c9984594ef8f110e90", "", "include"
    ),
}
SIZES: Final = {
    "z_id_t": (1, 16),
    "z_timestamp_t": (8, 24),
    "z_entity_global_id_t": (4, 20),
    "z_source_info_t": (4, 24),
}
"""Alignment and bytes of structs that are passed by value."""
NO_SHARED_MEMORY: Final = """\
#include <cstddef>
#include <cstdint>
#include <variant>
namespace zenoh {
struct ZShmMut { uint8_t * data() { return nullptr; } };
struct ShmProvider { std::variant<ZShmMut, int> alloc_gc_defrag(size_t) { return 0; } };
struct SharedShmProvider { ShmProvider shm_provider() const { return {}; } };
}
"""
CONFIGURE: Final = """\
#define Z_FEATURE_UNSTABLE_API
#define ZENOH_C_MAJOR 1
#define ZENOH_C_MINOR 8
#define ZENOH_C_PATCH 0
"""
LINKED: Final = (
    *("rmw", "rcutils", "rcpputils", "fastcdr", "rosidl_typesupport_fastrtps_cpp", "rosidl_typesupport_fastrtps_c"),
    *("ament_index_cpp", "tracetools", "rosidl_runtime_c", "zenohc_core"),
)
FLAGS: Final = (
    *("-std=c++17", "-fPIC", "-O1", "-w", "-include", "no_shared_memory.hpp", "-DZENOHCXX_ZENOHC"),
    *("-DRMW_VERSION_MAJOR=7", "-DRMW_VERSION_MINOR=8", "-DRMW_VERSION_PATCH=2"),
)


def main(where: Path) -> None:
    if (where / "ready").exists():
        return
    shutil.rmtree(where, ignore_errors=True)
    venv, source = where / "venv", where / "source"
    run("python3.11", "-m", "venv", str(venv))
    run(str(venv / "bin" / "pip"), "install", "--quiet", *ROS)
    for name, each in SOURCES.items():
        fetch(each, source / name)
    write_zenoh_c_headers(source / "c")
    cut_out_shared_memory(source)
    shutil.copy(zenoh_c_symbols(venv, where), venv / "lib" / "libzenohc_core.so")
    build(source, venv)
    shutil.copytree(source / "rmw" / "config", venv / "share" / "rmw_zenoh_cpp" / "config")
    (venv / "share" / "ament_index" / "resource_index" / "packages" / "rmw_zenoh_cpp").touch()
    (where / "ready").touch()


def environment(where: Path = HERE) -> dict[str, str]:
    """Return the variables with which `venv/bin/python` runs rclpy on rmw_zenoh_cpp."""
    venv = where / "venv"
    libraries = [venv / "lib", *(venv / "lib" / "python3.11" / "site-packages").glob("ros_*.libs")]
    return {
        "AMENT_PREFIX_PATH": str(venv),
        "LD_LIBRARY_PATH": ":".join(map(str, libraries)),
        # The wheels' librcl is linked to Fast DDS: RMW_IMPLEMENTATION alone does not replace it.
        "LD_PRELOAD": str(venv / "lib" / "librmw_zenoh_cpp.so"),
        "RMW_IMPLEMENTATION": "rmw_zenoh_cpp",
        "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1",
    }


def run(*words: str, **options: object) -> bytes:
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, **options).stdout  # type: ignore[call-overload,no-any-return]


def fetch(each: Source, into: Path) -> None:
    """Take one commit's files of a repository."""
    git = ("git", "-C", str(into))
    into.mkdir(parents=True)
    run(*git, "init", "--quiet")
    wanted = each.branch or each.commit
    run(*git, "fetch", "--quiet", "--depth=1", each.repository, wanted)
    run("tar", "--extract", "--directory", str(into), input=run(*git, "archive", each.commit, each.path))


def write_zenoh_c_headers(zenoh_c: Path) -> None:
    """Write the headers that zenoh-c's own build generates.

    Structs are larger than the real ones, which is safe: zenoh-c is given their addresses.
    """
    include = zenoh_c / "include"
    sizes = (zenoh_c / "build-resources" / "opaque-types" / "src" / "lib.rs").read_text()
    names = set(re.findall(r"get_opaque_type_data!\(.*?,\s*(z\w+_t)\s*,?\s*\);", sizes, re.DOTALL))
    names |= {"z_owned_alloc_layout_t", "z_loaned_alloc_layout_t"}
    written = "".join((include / name).read_text() for name in ("zenoh_commons.h", "zenoh_concrete.h"))
    done = set(re.findall(r"^\}\s*(z\w+_t);", written, re.MULTILINE))
    lines = []
    for name in sorted(names):
        align, size = SIZES.get(name, (8, 4096 if "config" in name else 512))
        field = "id" if name == "z_id_t" else "_0"
        if name not in done:
            lines.append(f"typedef struct ALIGN({align}) {name} {{ uint8_t {field}[{size}]; }} {name};")
        owned = re.match(r"(z[ec]?)_owned_(\w+_t)$", name)
        if owned and (moved := f"{owned[1]}_moved_{owned[2]}") not in done:
            lines.append(f"typedef struct {moved} {{ struct {name} _this; }} {moved};")
    (include / "zenoh_opaque.h").write_text("\n".join(lines) + "\n")
    (include / "zenoh_configure.h").write_text(CONFIGURE)
    macros = include / "zenoh_macros.h"
    shared = re.compile("shm|memory_layout|precomputed_layout|ptr_in_segment|chunk_alloc")
    before, mark, after = macros.read_text().partition("#else")
    kept = [unit for unit in units((mark + after).split("\n")) if unit.startswith("#") or not shared.search(unit)]
    macros.write_text(before + "\n".join(kept))


def units(lines: list[str]) -> Iterator[str]:
    """Give C++ text in whole directives and functions."""
    unit: list[str] = []
    for line in lines:
        unit.append(line)
        text = "".join(unit)
        is_single = unit[0].startswith(("#", "extern", "}", "/"))
        is_open = (
            text.count("{") != text.count("}")
            or text.count("(") != text.count(")")
            or line.rstrip().endswith((",", ")"))
            or (text.startswith("template") and len(unit) == 1 and "{" not in text)
        )
        if is_single or not is_open:
            yield "\n".join(unit)
            unit = []
    yield "\n".join(unit)


def cut_out_shared_memory(source: Path) -> None:
    detail = source / "rmw" / "src" / "detail"
    publisher, session = detail / "rmw_publisher_data.cpp", detail / "zenoh_utils.cpp"
    text = publisher.read_text().replace("payload = zenoh::Bytes(std::move(*shm_buf));", "payload = zenoh::Bytes();")
    publisher.write_text(text.replace("zenoh::Bytes payload(std::move(*shm_buf));", "zenoh::Bytes payload;"))
    before, _, after = session.read_text().partition("  auto maybe_provider = session.obtain")
    session.write_text(f"{before}  return std::nullopt;{after[after.index(chr(10) + '}') :]}")
    (source / "no_shared_memory.hpp").write_text(NO_SHARED_MEMORY)


def zenoh_c_symbols(venv: Path, where: Path) -> Path:
    """Return a library that exports zenoh-c's symbols."""
    run(str(venv / "bin" / "pip"), "download", "--quiet", "--no-deps", ZENOH_C_SYMBOLS, "--dest", str(where / "wheel"))
    [wheel] = (where / "wheel").glob("*.whl")
    with zipfile.ZipFile(wheel) as files:
        [name] = [each for each in files.namelist() if each.endswith(".so")]
        return Path(files.extract(name, where / "wheel"))


def build(source: Path, venv: Path) -> None:
    """Compile and link rmw_zenoh_cpp."""
    files = [*source.glob("rmw/src/*.cpp"), *source.glob("rmw/src/detail/*.cpp")]
    names = [str(each.relative_to(source)) for each in files if "fixture" not in each.name]
    own = [source / each for each in ("c/include", "cpp/include", "rmw/src", "rmw/include")]
    folders = [*own, venv / "include", *(venv / "include").glob("*/")]
    compiler = ("g++", *FLAGS, *(f"-I{each}" for each in folders))
    each_file = ("xargs", "-P2", "-I{}", *compiler, "-c", "{}", "-o", "{}.o")
    run(*each_file, input="\n".join(names).encode(), cwd=source)
    library = venv / "lib"
    linker = ("g++", "-shared", "-o", str(library / "librmw_zenoh_cpp.so"), *(f"{name}.o" for name in names))
    where = (f"-L{library}", *(f"-l{name}" for name in LINKED), "-Wl,-rpath,$ORIGIN", "-Wl,--allow-shlib-undefined")
    run(*linker, *where, cwd=source)


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else HERE)
