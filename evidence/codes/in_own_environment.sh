#!/bin/sh
# Runs a script of this folder with the packages of its line "# needs PACKAGE==VERSION ...", in a new
# environment that is removed afterwards:   sh in_own_environment.sh in_pybullet.py
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
script=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
python3 -m venv "$folder/v"
"$folder/v/bin/pip" -q install $(sed -n 's/^# needs //p' "$script")
cd "$folder"
OMP_NUM_THREADS=1 "$folder/v/bin/python" "$script"
