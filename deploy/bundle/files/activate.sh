#!/bin/sh
# Makes an installed version the one that is used. Usage: activate.sh BUILD (a folder of /opt/weldgate)
# install.sh and rollback.sh call it, each the one of the version that shall be used.
set -eu
umask 022
root=${WELDGATE_ROOT:-}
base=$root/opt/weldgate
build=$1
scripts=$base/$build/setup
services="weldgate-engine.service weldgate-window.service"
systemd=no
[ -n "$root" ] || [ ! -d /run/systemd/system ] || systemd=yes

[ -e "$base/$build/.complete" ] || {
    echo "activate.sh: no complete version in $base/$build. Nothing was changed." >&2
    exit 2
}

put() { # put SOURCE DESTINATION: whole or not at all
    mkdir -p "$(dirname "$2")"
    cp "$1" "$2.new"
    chmod 644 "$2.new"
    mv -T "$2.new" "$2"
}

link() { # link TARGET NAME: replaces an older link in one step
    mkdir -p "$(dirname "$2")"
    ln -sfn "$1" "$2.new"
    mv -T "$2.new" "$2"
}

if [ -z "$root" ]; then
    getent group weldgate >/dev/null || groupadd --system weldgate
    getent passwd weldgate >/dev/null ||
        useradd --system --gid weldgate --home-dir /var/lib/weldgate --no-create-home --shell /usr/sbin/nologin weldgate
fi
for folder in etc/weldgate var/lib/weldgate var/lib/weldgate/records; do
    mkdir -p "$root/$folder"
    chmod 750 "$root/$folder"
done
if [ ! -e "$root/etc/weldgate/station.toml" ]; then
    set -- "$base/$build"/lib/python*/site-packages/weldgate/deploy/station.toml
    sed -e "s|\"../models/shipped/|\"$base/current/networks/|" -e "s|\"../records\"|\"$root/var/lib/weldgate/records\"|" \
        "$1" >"$root/etc/weldgate/station.toml.new"
    chmod 640 "$root/etc/weldgate/station.toml.new"
    mv -T "$root/etc/weldgate/station.toml.new" "$root/etc/weldgate/station.toml"
fi
if [ -z "$root" ]; then
    chown weldgate:weldgate /var/lib/weldgate /var/lib/weldgate/records
    # the engine writes the changes of the station next to the settings
    chown weldgate:weldgate /etc/weldgate /etc/weldgate/station.toml
fi

running=
if [ $systemd = yes ]; then
    for service in $services; do
        systemctl is-active --quiet "$service" && running="$running $service"
    done
    # shellcheck disable=SC2086  # a list of names
    [ -z "$running" ] || systemctl stop $running
fi

for service in $services; do put "$scripts/$service" "$root/etc/systemd/system/$service"; done
put "$scripts/60-weldgate.conf" "$root/etc/sysctl.d/60-weldgate.conf"
put "$scripts/60-weldgate.rules" "$root/etc/udev/rules.d/60-weldgate.rules"
before=$(readlink "$base/current" 2>/dev/null || true)
[ -z "$before" ] || [ "$before" = "$build" ] || link "$before" "$base/previous"
link "$build" "$base/current"
link "$base/current/bin/weldgate" "$root/usr/local/bin/weldgate"
link "$base/current/setup/rollback.sh" "$root/usr/local/sbin/weldgate-rollback"
link "$base/current/setup/uninstall.sh" "$root/usr/local/sbin/weldgate-uninstall"
if [ -n "$before" ]; then # keep this version and the one before
    for folder in "$base"/*/; do
        name=$(basename "$folder")
        case $name in "$build" | "$before" | current | previous) ;; *) rm -rf "${base:?}/$name" ;; esac
    done
fi

if [ $systemd = yes ]; then
    systemctl daemon-reload
    systemctl enable --quiet weldgate-engine.service weldgate-window.service
    sysctl --quiet --load /etc/sysctl.d/60-weldgate.conf || echo "activate.sh: network settings take effect at the next start" >&2
    udevadm control --reload || true
    # shellcheck disable=SC2086  # a list of names
    [ -z "$running" ] || systemctl start $running
fi
echo "weldgate $build is in use. Settings: $root/etc/weldgate/station.toml. Next: weldgate check -c $root/etc/weldgate/station.toml"
