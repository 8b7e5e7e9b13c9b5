#!/usr/bin/env bash
# Installs what building, testing and running need: Debian 12 packages and nothing else.
set -euo pipefail

packages=(
    # tools
    ca-certificates ccache clang-format-14 clang-tidy-14 cmake g++ git glslang-tools ninja-build pkg-config python3
    # libraries
    libaravis-dev libbenchmark-dev libceres-dev libcli11-dev libegl-dev libeigen3-dev libembree-dev libepoxy-dev libfmt-dev libglfw3-dev libglm-dev libgmock-dev libgtest-dev libhwy-dev libimgui-dev
    libopencv-dev libopenexr-dev libopenimageio-dev libpng-dev libpugixml-dev libtbb-dev libtinygltf-dev libusb-1.0-0-dev libxxhash-dev nlohmann-json3-dev
    # OpenGL on the CPU, for tests and for machines without a graphics card
    libegl1 libgl1-mesa-dri
    # a display without a screen, and a mouse and keyboard for it: tests of the viewer
    xdotool xvfb
    # simulated V4L2, USB and serial devices; the programs that see them too
    libumockdev-dev umockdev usbutils v4l-utils
    # the reader of docs/read_luminaire.py, plots in reports
    gnuplot-nox python3-numpy python3-openimageio
)

missing=()
for package in "${packages[@]}"; do
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
    echo "setup: all ${#packages[@]} packages are installed"
    exit 0
fi

echo "setup: installing ${missing[*]}"
as_root=()
if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo)
fi
"${as_root[@]}" apt-get update -qq
DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}"
