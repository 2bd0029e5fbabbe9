#!/usr/bin/env bash
# Speed against accuracy of vibro and of other programs on this machine, in one run:
#
#     benches/peers/precision.sh [DIR]
#
# Builds vibro, installs the other programs (requirements.txt) under the target folder, measures both, and writes charts and tables
# to DIR (default: precision). Takes two minutes behind the build; let nothing else run beside it. PYTHON names an interpreter that has the other programs,
# VIBRO a program that is built.
set -euo pipefail
out=$(realpath -m "${1:-precision}")
cd "$(dirname "$0")/../.."
target=${CARGO_TARGET_DIR:-target}
if [ -z "${PYTHON:-}" ]; then
    PYTHON=$target/peers/bin/python
    [ -x "$PYTHON" ] || python3 -m venv "$target/peers"
    "$PYTHON" -m pip install --quiet --disable-pip-version-check -r benches/peers/requirements.txt
fi
if [ -z "${VIBRO:-}" ]; then
    cargo build --release --locked
    VIBRO=$target/release/vibro
fi
measured=$(mktemp -d)
trap 'rm -r "$measured"' EXIT
"$VIBRO" precision --family models --json > "$measured/vibro.json"
"$PYTHON" benches/peers/peers.py "$measured/peers.json"
"$VIBRO" precision --from "$measured/vibro.json" --add "$measured/peers.json" --out "$out"
