#!/usr/bin/env python3
"""Checks that includes follow the layers, and that a third-party library stays behind its folder.

formats/files <- formats/{model,capture} <- formats/{rays,photometry,farfield,proxies,scene,report,environment} <- {acquire, calibrate, render, sample_data} <- app; tests use all.
formats/shared is used by all. Prints each breach as file:line and exits 1 if there is one.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# What a folder may include of the project, besides itself. The longest matching prefix of a path is its folder.
ALLOWED = {
    "formats/files": [],
    "formats/capture": ["formats/files"],
    "formats/shared": [],
    "formats/photos": ["formats/files", "formats/capture"],
    "formats/model": ["formats/files", "formats/shared"],
    "formats/rig": ["formats/files"],
    "formats/photometry": ["formats/files", "formats/model"],
    "formats/farfield": ["formats/files", "formats/model", "formats/photometry"],
    "formats/proxies": ["formats/files", "formats/model"],
    "formats/rays": ["formats/files", "formats/model", "formats/shared"],
    "formats/scene": ["formats/files", "formats/shared"],
    "formats/report": ["formats/files"],
    "formats/environment": ["formats/files", "formats/model", "formats/photos", "formats/shared"],
    "acquire": ["formats"],
    "calibrate": ["formats"],
    "fit": ["formats"],
    "render": ["formats"],
    "sample_data": ["formats"],
    "app": ["formats", "acquire", "calibrate", "fit", "render", "sample_data"],
    "tests": ["formats", "acquire", "calibrate", "fit", "render", "sample_data", "app"],
}

# Where a library's headers may be included.
LIBRARIES = {
    r"openexr|OpenEXR|Imf|Imath": ["formats/files", "tests/files"],
    r"png\.h": ["formats/files", "formats/capture", "tests"],
    r"xxhash": ["formats/files"],
    r"tiny_gltf|tinygltf": ["formats/scene"],
    r"pugixml": ["formats/photometry", "formats/proxies"],
    r"embree": ["render/cpu"],
    r"epoxy/": ["render/gpu", "app/viewer", "tests/render/gpu", "tests/viewer"],
    r"GLFW/|imgui|backends/imgui": ["app/viewer", "tests/viewer"],
    r"hwy/": ["formats/model"],
    r"OpenImageIO/": ["formats/photos"],
    r"arv\.h": ["acquire", "tests/sample_data", "tests/acquire"],
    r"libusb-1.0/": ["acquire"],
    r"umockdev\.h": ["sample_data/devices"],
    r"CLI/": ["app"],
    r"opencv2/": ["calibrate", "fit", "tests"],
    r"ceres/": ["calibrate", "tests/calibrate"],
    r"Eigen/": ["calibrate", "fit", "tests"],
    r"nlohmann/": ["formats/files", "formats/proxies", "formats/scene", "app", "tests"],
}


def folder_of(path):
    matches = [folder for folder in ALLOWED if path == folder or path.startswith(folder + "/")]
    return max(matches, key=len) if matches else None


def is_under(path, folders):
    return any(path == folder or path.startswith(folder + "/") for folder in folders)


def breaches_of(path):
    name = path.relative_to(ROOT).as_posix()
    folder = folder_of(name)
    for number, line in enumerate(path.read_text().splitlines(), 1):
        match = re.match(r'\s*#\s*include\s+(["<])([^">]+)[">]', line)
        if not match:
            continue
        kind, included = match.groups()
        if kind == '"':
            target = folder_of(included)
            if target is None:
                yield f"{name}:{number}: includes {included}: not a path from the project's root"
            elif target != folder and not is_under(included, ALLOWED[folder]):
                yield f"{name}:{number}: {folder} must not include {included}"
        else:
            for pattern, folders in LIBRARIES.items():
                if re.match(pattern, included) and not is_under(name, folders):
                    yield f"{name}:{number}: <{included}> belongs behind {', '.join(folders)}"


def main():
    breaches = []
    files = [p for folder in ALLOWED for p in (ROOT / folder).rglob("*") if p.suffix in (".h", ".cpp")]
    for path in sorted(set(files)):
        breaches.extend(breaches_of(path))
    for breach in breaches:
        print(breach)
    print(f"{len(set(files))} files, {len(breaches)} breaches of the layers")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
