#!/bin/sh
# Runs a script of this folder with the packages of its line "needs PACKAGE==VERSION ...", in a new
# environment that is removed afterwards:   sh in_own_environment.sh in_pybullet.py
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
script=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
packages=$(sed -n '1s/^[#/]* needs //p' "$script")
cd "$folder"
case $script in
*.mjs)
    cp "$script" .
    npm init -y > /dev/null
    npm install --silent $packages
    node "$(basename "$script")"
    ;;
*)
    python3 -m venv v
    v/bin/pip -q install $packages
    OMP_NUM_THREADS=1 v/bin/python "$script"
    ;;
esac
