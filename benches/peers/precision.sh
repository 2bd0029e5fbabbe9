#!/usr/bin/env bash
# Speed against accuracy of vibro and of other programs on this machine, in one run:
#
#     benches/peers/precision.sh [DIR]
#
# Builds vibro, installs the other programs (requirements.txt) under the target folder, measures both, and writes charts and tables
# to DIR (default: precision), and prints a table of the estimators. Takes four minutes behind the build; let nothing else run beside it. PYTHON names an
# interpreter that has the other programs, VIBRO a program that is built.
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
cargo run --quiet --release --locked -p vibro-precision --example records -- "$measured"
"$VIBRO" precision --json > "$measured/vibro.json"
"$PYTHON" benches/peers/peers.py "$measured/peers.json"
# One thread each, as vibro has for one record.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
"$PYTHON" benches/peers/estimators.py "$measured" "$measured/estimators.json" "$measured/vibro.json" > "$measured/estimators.md"
"$VIBRO" precision --results "$measured/vibro.json" --add "$measured/peers.json" --add "$measured/estimators.json" --out "$out"
cat "$measured/estimators.md"
