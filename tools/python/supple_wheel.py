"""Backend of `pip install .` (PEP 517): builds the package by CMake and packs it into a wheel.

The wheel runs on any Linux x86-64 whose libc and libstdc++ are not older than those of the machine
that made it: `supple/_native` holds the program, the shared library, its plugins and, with their
licences, all libraries that the program needs. Libraries of plugins are used where installed.
SUPPLE_BUILD_DIR takes a folder that is built already; else the preset `portable` is built. Needs
patchelf, strip, and dpkg, which knows the licences.
"""
import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
VERSION, SUMMARY = re.search(r'project\(supple VERSION (\S+) DESCRIPTION "(.*?)"',
                             (ROOT / "CMakeLists.txt").read_text()).groups()
INFO = f"supple-{VERSION}.dist-info"
TAG = "cp{0}{1}-cp{0}{1}-{2}".format(*sys.version_info[:2],
                                     re.sub("[-.]", "_", sysconfig.get_platform()))
NOT_CARRIED = re.compile(r"ld-linux|linux-vdso|lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s)\.so")
# libtiff wants it, and it is under the GPL: one that refuses its images takes its place.
REFUSED = {"libjbig.so.0": """
const char* jbg_strerror(void) { return "JBIG is not in this package"; }
int jbg_dec_in(void) { return 32; }
int jbg_newlen(void) { return 32; }
long jbg_dec_getsize(void) { return 0; }
void *jbg_dec_getimage(void) { return 0; }
void jbg_dec_init(void) {}
void jbg_dec_free(void) {}
void jbg_enc_init(void) {}
void jbg_enc_out(void) {}
void jbg_enc_free(void) {}
"""}
SCRIPT = """#!python
import importlib.util, os, sys
package = os.path.dirname(importlib.util.find_spec("supple").origin)
os.execv(os.path.join(package, "_native", "supple"), ["supple", *sys.argv[1:]])
"""
METADATA = f"""Metadata-Version: 2.1
Name: supple
Version: {VERSION}
Summary: {SUMMARY}
License: Apache-2.0
Requires-Python: >=3.9
Requires-Dist: numpy
Description-Content-Type: text/markdown

{(ROOT / "README.md").read_text()}"""


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Makes the wheel in the folder and returns its name."""
    with tempfile.TemporaryDirectory() as stage:
        _fill(Path(stage), _build_folder())
        name = f"supple-{VERSION}-{TAG}.whl"
        _pack(Path(stage), Path(wheel_directory) / name)
    return name


def _build_folder():
    if os.environ.get("SUPPLE_BUILD_DIR"):
        build = Path(os.environ["SUPPLE_BUILD_DIR"]).resolve()
    else:
        build = ROOT / "build/portable"
        python = os.path.realpath(sys.executable)
        _run("cmake", "--preset", "portable", f"-DPython3_EXECUTABLE={python}", cwd=ROOT)
        _run("cmake", "--build", build, "--target", "supple_python", "supple", "supple_x86-64-v3")
    extension = build / "python/supple" / f"_supple{sysconfig.get_config_var('EXT_SUFFIX')}"
    for needed in (extension, build / "bin/supple"):
        if not needed.exists():
            sys.exit(f"{needed}: found no such file, expected the targets supple_python and supple "
                     f"to be built, for {sys.executable}")
    return build


def _fill(stage, build):
    package, native = stage / "supple", stage / "supple/_native"
    shutil.copytree(build / "python/supple", package, ignore=shutil.ignore_patterns("__pycache__"))
    native.mkdir()
    soname = "libsupple.so." + ".".join(VERSION.split(".")[:2])
    own = [native / soname, native / "supple", *package.glob("_supple.*.so")]
    shutil.copy(build / "lib" / soname, native)
    shutil.copy(build / "bin/supple", native)
    carried = _libraries(own)
    for name, path in carried.items():
        if name not in REFUSED:
            shutil.copy(path, native / name)
        else:
            _run("cc", "-x", "c", "-", "-shared", "-fPIC", f"-Wl,-soname,{name}", "-o",
                 native / name, input=REFUSED[name])
    for plugin in (build / "bin").glob("supple_*.so"):
        own.append(shutil.copy(plugin, native))
    for library in build.glob(f"x86-64-*/lib/{soname}"):  # the loader prefers what the processor can
        level = native / "glibc-hwcaps" / library.parts[-3]
        level.mkdir(parents=True)
        own.append(shutil.copy(library, level))
    _run("strip", "--strip-unneeded", *own)
    for file in [*package.glob("*.so"), *native.rglob("*")]:
        if file.is_file():
            to_native = os.path.relpath(native, file.parent)
            _run("patchelf", "--force-rpath", "--set-rpath", f"$ORIGIN/{to_native}", file)
    info = stage / INFO
    _copy_licences([path for name, path in carried.items() if name not in REFUSED],
                   info / "licenses")
    (info / "METADATA").write_text(METADATA)
    (info / "WHEEL").write_text("Wheel-Version: 1.0\nGenerator: supple_wheel\n"
                                f"Root-Is-Purelib: false\nTag: {TAG}\n")
    scripts = stage / f"supple-{VERSION}.data/scripts"
    scripts.mkdir(parents=True)
    (scripts / "supple").write_text(SCRIPT)
    (scripts / "supple").chmod(0o755)


def _libraries(files):
    """Name and path of all libraries that these files need and that not every machine has."""
    found = {}
    for line in _run("ldd", *files).splitlines():
        name, _, path = line.strip().partition(" => ")
        if path and not NOT_CARRIED.match(name) and not name.startswith("libsupple."):
            found[name] = path.split(" (")[0]
            if name.startswith("libtbb.so"):  # which loads it by itself
                allocator = Path(found[name]).with_name("libtbbmalloc.so.2")
                found.update({allocator.name: str(allocator)} if allocator.exists() else {})
    return dict(sorted(found.items()))


def _copy_licences(libraries, folder):
    folder.mkdir(parents=True)
    shutil.copy(ROOT / "LICENSE", folder / "supple.txt")
    patterns = [f"*/{os.path.basename(os.path.realpath(library))}" for library in libraries]
    owners = {line.split(":")[0] for line in _run("dpkg", "-S", *patterns).splitlines()}
    common = set()
    for package in owners:
        text = Path(f"/usr/share/doc/{package}/copyright").read_text(errors="replace")
        (folder / f"{package}.txt").write_text(text)
        common.update(re.findall(r"/usr/share/common-licenses/([A-Za-z0-9.-]*[A-Za-z0-9])", text))
    for name in common:
        shutil.copy(f"/usr/share/common-licenses/{name}", folder / f"{name}.txt")


def _pack(stage, wheel):
    """All files in a fixed order with a fixed time, so that equal builds give equal wheels."""
    record = []
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(path for path in stage.rglob("*") if path.is_file()):
            name, content = str(file.relative_to(stage)), file.read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=")
            record.append(f"{name},sha256={digest.decode()},{len(content)}\n")
            _add(archive, name, content, 0o755 if os.access(file, os.X_OK) else 0o644)
        _add(archive, f"{INFO}/RECORD", "".join(record) + f"{INFO}/RECORD,,\n", 0o644)


def _add(archive, name, content, mode):
    entry = zipfile.ZipInfo(name)
    entry.external_attr, entry.compress_type = (0o100000 | mode) << 16, zipfile.ZIP_DEFLATED
    archive.writestr(entry, content)


def _run(*command, **how):
    """Standard output of a program; it ends this one where it fails or is missing."""
    try:
        return subprocess.run([str(word) for word in command], check=True, text=True,
                              stdout=subprocess.PIPE, **how).stdout
    except FileNotFoundError:
        sys.exit(f"{command[0]}: found no such program, expected it for a wheel")
    except subprocess.CalledProcessError as error:
        sys.exit(f"{command[0]}: {error.stdout.strip()}\nfound exit code {error.returncode}")
