#!/bin/sh
# Removes weldgate. Records, settings and journal stay: /var/lib/weldgate and /etc/weldgate. Usage: weldgate-uninstall
set -eu
root=${WELDGATE_ROOT:-}
[ -n "$root" ] || [ "$(id -u)" -eq 0 ] || {
    echo "weldgate-uninstall: root is needed: sudo weldgate-uninstall. Nothing was changed." >&2
    exit 2
}
if [ -z "$root" ] && [ -d /run/systemd/system ]; then
    systemctl disable --quiet --now weldgate-window.service weldgate-engine.service 2>/dev/null || true
fi
if grep -qlsa "opt/weldgate/[^/]*/bin/python" /proc/[0-9]*/cmdline; then
    echo "weldgate-uninstall: the station is running: end it first. Nothing was removed." >&2
    exit 2
fi
rm -f "$root/etc/systemd/system/weldgate-engine.service" "$root/etc/systemd/system/weldgate-window.service" \
    "$root/etc/sysctl.d/60-weldgate.conf" "$root/etc/udev/rules.d/60-weldgate.rules" \
    "$root/usr/local/bin/weldgate" "$root/usr/local/sbin/weldgate-rollback" "$root/usr/local/sbin/weldgate-uninstall"
rm -rf "$root/opt/weldgate"
if [ -z "$root" ] && [ -d /run/systemd/system ]; then systemctl daemon-reload; fi
echo "weldgate is removed. Kept: $root/var/lib/weldgate, $root/etc/weldgate and the user weldgate, who owns them."
