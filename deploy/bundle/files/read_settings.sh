#!/bin/sh
# Says whether the version in whose setup folder this file is can use a settings file. Usage: read_settings.sh FILE
set -eu
home=$(CDPATH='' cd "$(dirname "$0")/.." && pwd)
settings=$1
set -- "$home"/lib/python*/site-packages/weldgate/station/files/installation.py
exec "$home/bin/python" -P "$1" deploy.bundle.read_settings "$settings"
