#!/usr/bin/env bash
# System libraries that the packages need, through apt, only what is missing. Usage: system.sh
set -euo pipefail

have() { ldconfig -p | grep -q "$1"; }

packages=()
python3 -c 'import ensurepip, venv' 2>/dev/null || packages+=(python3-venv)
have 'libEGL.so.1' || packages+=(libegl1)
have 'libGL.so.1' || packages+=(libgl1)
have 'libxcb-cursor.so.0' || packages+=(libxcb-cursor0)
have 'libxkbcommon-x11.so.0' || packages+=(libxkbcommon-x11-0)
have 'libdbus-1.so.3' || packages+=(libdbus-1-3)
have 'libfontconfig.so.1' || packages+=(libfontconfig1)
have 'libglib-2.0.so.0' || packages+=(libglib2.0-0)
ls /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf >/dev/null 2>&1 || packages+=(fonts-dejavu-core)
have 'libLLVM.so.19\|libLLVM-19' || packages+=(libllvm19)
[ ${#packages[@]} -eq 0 ] && exit 0

if ! command -v apt-get >/dev/null; then
    echo "system.sh: these libraries are missing, and there is no apt-get to install them: ${packages[*]}" >&2
    exit 1
fi
root=()
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "system.sh: run as root once: apt-get install ${packages[*]}" >&2; exit 1; }
    root=(sudo)
fi
echo "installing: ${packages[*]}"
"${root[@]}" apt-get update -qq
DEBIAN_FRONTEND=noninteractive "${root[@]}" apt-get install -y -qq --no-install-recommends "${packages[@]}" >/dev/null
