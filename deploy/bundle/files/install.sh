#!/bin/sh
# Installs weldgate from this folder, without a network. Usage: install.sh [--restart] [--key PUBLIC_KEY.pem]
# --restart: stop a running station and start it again with the new version
# --key: refuse the bundle unless SHA256SUMS.sig was made with the private key that belongs to this one
# WELDGATE_ROOT installs below another folder, without user and services; the tests use it.
set -eu
umask 022
here=$(CDPATH='' cd "$(dirname "$0")" && pwd)
root=${WELDGATE_ROOT:-}
base=$root/opt/weldgate
new=

fail() {
    echo "install.sh: $1" >&2
    exit 2
}

clean_up() {
    code=$?
    trap - EXIT
    if [ -n "$new" ] && [ ! -e "$new/.complete" ]; then
        rm -rf "$new"
        echo "install.sh: stopped; the half of the new version is removed, what was installed is unchanged" >&2
    fi
    rmdir "$base" 2>/dev/null || true
    exit "$code"
}

restart=no
key=
while [ $# -gt 0 ]; do
    case $1 in
        --restart) restart=yes ;;
        --key)
            [ $# -ge 2 ] || fail "--key needs a file. Nothing was changed."
            key=$2
            shift
            ;;
        *) fail "unknown option: $1. Usage: install.sh [--restart] [--key PUBLIC_KEY.pem]. Nothing was changed." ;;
    esac
    shift
done

[ -n "$root" ] || [ "$(id -u)" -eq 0 ] || fail "root is needed: sudo sh $here/install.sh. Nothing was changed."

# shellcheck disable=SC1090,SC1091  # a file of the system that is installed on
system=$(. "${WELDGATE_OS_RELEASE:-/etc/os-release}" && echo "${ID:-unknown}-${VERSION_ID:-unknown}")
machine=$(uname -m)
case $system in
    debian-12) python=3.11 ;;
    debian-13) python=3.13 ;;
    ubuntu-24.04) python=3.12 ;;
    *) fail "$system is not supported: needs Debian 12, Debian 13 or Ubuntu 24.04. Nothing was changed." ;;
esac
[ "$machine" = x86_64 ] || fail "$machine is not supported: needs x86_64. Nothing was changed."
command -v python3 >/dev/null || fail "python3 is missing: install the package python3. Nothing was changed."
found=$(python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')
[ "$found" = "$python" ] || fail "python3 is $found, but $system has $python: repair it. Nothing was changed."
python3 -c 'import venv' 2>/dev/null || fail "module venv of python3 is missing: install python3-venv. Nothing was changed."
[ -e "$here/requirements-$python.txt" ] ||
    fail "this bundle has no packages for $system: build one with --system $system. Nothing was changed."

known=$(ldconfig -p 2>/dev/null || /sbin/ldconfig -p)
missing=
while read -r library package; do
    case $known in *"$library"*) ;; *) missing="$missing $package" ;; esac
done <"$here/libraries.txt"
[ -z "$missing" ] || fail "system libraries are missing: install the packages$missing. Nothing was changed."

if [ -n "$key" ]; then
    [ -r "$key" ] || fail "public key cannot be read: $key. Nothing was changed."
    [ -e "$here/SHA256SUMS.sig" ] || fail "the bundle is not signed: SHA256SUMS.sig is missing. Nothing was changed."
    command -v openssl >/dev/null || fail "openssl is missing: install the package openssl. Nothing was changed."
    openssl pkeyutl -verify -pubin -inkey "$key" -rawin -in "$here/SHA256SUMS" \
        -sigfile "$here/SHA256SUMS.sig" >/dev/null 2>&1 ||
        fail "the signature of the bundle does not belong to $key: get the bundle again. Nothing was changed."
fi
(cd "$here" && sha256sum --check --quiet --strict SHA256SUMS >/dev/null 2>&1) || {
    bad=$(cd "$here" && LC_ALL=C sha256sum --check --quiet SHA256SUMS 2>/dev/null | sed 's/: FAILED.*//' | head -n 3 | tr '\n' ' ')
    fail "the bundle is damaged: ${bad:-SHA256SUMS} differs from its checksum. Copy it again. Nothing was changed."
}

version=$(cat "$here/VERSION")
sum=$(sha256sum "$here/SHA256SUMS" | cut -c 1-8)
build=$version-$sum
active=$(readlink "$base/current" 2>/dev/null || true)
if [ "$active" = "$build" ] && [ -e "$base/$build/.complete" ]; then
    echo "weldgate $build is already installed; nothing was changed."
    exit 0
fi

if [ "$restart" = no ] && grep -qlsa "opt/weldgate/[^/]*/bin/python" /proc/[0-9]*/cmdline; then
    fail "the station is running: stop it (systemctl stop weldgate-engine weldgate-window), or repeat with --restart. Nothing was changed."
fi

place=$root/opt
while [ ! -d "$place" ]; do place=$(dirname "$place"); done
need_mb=$(cat "$here/SIZE_MB")
free_mb=$(($(df -Pk "$place" | awk 'NR == 2 { print $4 }') / 1024))
[ "$free_mb" -ge "$need_mb" ] ||
    fail "$place has $free_mb MB free, $need_mb MB are needed: free some space. Nothing was changed."

trap clean_up EXIT
trap 'exit 130' INT TERM HUP
mkdir -p "$base" "$root/run"
exec 9>"$root/run/weldgate-install.lock"
flock -n 9 || fail "another installation is running. Nothing was changed."
for folder in "$base"/*/; do # left by an installation that lost its power
    folder=${folder%/}
    [ -L "$folder" ] || [ -e "$folder/.complete" ] || [ ! -d "$folder" ] || rm -rf "$folder"
done

if [ ! -e "$base/$build/.complete" ]; then
    new=$base/$build
    echo "installing weldgate $build in $new"
    python3 -m venv --without-pip "$new"
    set -- "$here"/tools/pip-*.whl
    PYTHONPATH=$1 PIP_CONFIG_FILE=/dev/null "$new/bin/python" -m pip --disable-pip-version-check install --quiet --no-index \
        --no-cache-dir --find-links "$here/wheels" --require-hashes -r "$here/requirements-$python.txt" ||
        fail "the packages could not be installed; the lines above say why."
    mkdir "$new/setup"
    cp "$here"/files/* "$new/setup/"
    chmod 755 "$new"/setup/*.sh
    set -- "$new"/lib/python*/site-packages/weldgate/models/shipped
    ln -s "${1#"$new"/}" "$new/networks"
    "$new/bin/weldgate" --version >/dev/null || fail "the installed weldgate does not start; the lines above say why."
    settings=$root/etc/weldgate/station.toml
    [ ! -e "$settings" ] || sh "$new/setup/read_settings.sh" "$settings" ||
        fail "the new version cannot use $settings; the line above says why."
    sync
    : >"$new/.complete"
fi
WELDGATE_ROOT=$root sh "$base/$build/setup/activate.sh" "$build"
