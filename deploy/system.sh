#!/usr/bin/env bash
# Installs missing system libraries with apt. Usage: system.sh [test]
# test: also installs what PDF reports need, the Modbus programs that the tests use, and a compiler for them.
set -euo pipefail

# library file = package of Debian and Ubuntu; for Qt (xcb platform, OpenGL), pylon and Mitsuba (LLVM)
needed=(
    libEGL.so.1=libegl1
    libGL.so.1=libgl1
    libglib-2.0.so.0=libglib2.0-0
    libfontconfig.so.1=libfontconfig1
    libdbus-1.so.3=libdbus-1-3
    libX11-xcb.so.1=libx11-xcb1
    libxcb-cursor.so.0=libxcb-cursor0
    libxcb-icccm.so.4=libxcb-icccm4
    libxcb-image.so.0=libxcb-image0
    libxcb-keysyms.so.1=libxcb-keysyms1
    libxcb-randr.so.0=libxcb-randr0
    libxcb-render-util.so.0=libxcb-render-util0
    libxcb-shape.so.0=libxcb-shape0
    libxcb-sync.so.1=libxcb-sync1
    libxcb-xfixes.so.0=libxcb-xfixes0
    libxcb-xkb.so.1=libxcb-xkb1
    libxkbcommon-x11.so.0=libxkbcommon-x11-0
    libLLVM.so.19.1=libllvm19
)

known=$(ldconfig -p)
packages=()
for entry in "${needed[@]}"; do
    grep -qF "${entry%%=*}" <<<"$known" || packages+=("${entry#*=}")
done
python3 -c 'import ensurepip, venv' 2>/dev/null || packages+=(python3-venv)
[ -e /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf ] || packages+=(fonts-dejavu-core)
if [ "${1:-}" = test ]; then
    grep -qF libpango-1.0.so.0 <<<"$known" || packages+=(libpango-1.0-0)
    grep -qF libpangoft2-1.0.so.0 <<<"$known" || packages+=(libpangoft2-1.0-0)
    grep -qF libharfbuzz-subset.so.0 <<<"$known" || packages+=(libharfbuzz-subset0)
    command -v mbpoll >/dev/null || packages+=(mbpoll)
    command -v gcc >/dev/null || packages+=(gcc libc6-dev)
    [ -e /usr/include/modbus/modbus.h ] || packages+=(libmodbus-dev)
    include=$(python3 -c 'import sysconfig; print(sysconfig.get_path("include"))')
    [ -e "$include/Python.h" ] || packages+=(python3-dev)
fi
[ ${#packages[@]} -eq 0 ] && exit 0

if ! command -v apt-get >/dev/null; then
    echo "system.sh: libraries are missing, but apt-get is not available: install ${packages[*]}" >&2
    exit 1
fi
root=()
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
        echo "system.sh: libraries are missing; run as root: apt-get install ${packages[*]}" >&2
        exit 1
    }
    root=(sudo)
fi
echo "installing: ${packages[*]}"
"${root[@]}" apt-get update -qq
"${root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends "${packages[@]}" >/dev/null
