#!/bin/sh
# Goes back to the version that was in use before. Usage: weldgate-rollback. Run it again to undo it.
set -eu
root=${WELDGATE_ROOT:-}
base=$root/opt/weldgate
[ -n "$root" ] || [ "$(id -u)" -eq 0 ] || {
    echo "weldgate-rollback: root is needed: sudo weldgate-rollback. Nothing was changed." >&2
    exit 2
}
before=$(readlink "$base/previous" 2>/dev/null || true)
[ -n "$before" ] && [ -e "$base/$before/.complete" ] || {
    echo "weldgate-rollback: no version before this one is installed. Nothing was changed." >&2
    exit 2
}
settings=$root/etc/weldgate/station.toml
sh "$base/$before/setup/read_settings.sh" "$settings" || {
    echo "weldgate-rollback: $before cannot use $settings; the line above says why. Nothing was changed." >&2
    exit 2
}
exec sh "$base/$before/setup/activate.sh" "$before"
