#!/usr/bin/env bash
# Builds what a release has from one machine into a folder, and tries the programs that run here: build.sh FOLDER
# PROGRAMS are the targets of `vibro`, WHEELS those of the Python package, `sdist` among them for its sources. The first of each should run here.
set -euo pipefail
mkdir -p "$1"
to=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."
python=$(command -v python3 || command -v python)

# The C library of the toolchain for each, and its Rust.
for target in $PROGRAMS $WHEELS; do
  [ "$target" = sdist ] || rustup --quiet target add "$target"
done

# The page with the whole tool, which every program brings; with the licences of what is in it, once.
rustup --quiet target add wasm32-unknown-unknown
mkdir -p target/app
crates/vibro-app/build.sh target/app
export VIBRO_APP=$PWD/target/app/vibro.html
if [ "$(uname)" = Linux ]; then
  cp "$VIBRO_APP" "$to"
  "$python" packaging/workspace.py vibro-app wasm32-unknown-unknown >"$to/vibro.html-LICENSES.txt"
fi

# The program that prints the manual page for those that do not run here.
speaker=()
for target in $PROGRAMS; do
  "$python" packaging/archive.py "$target" "$to" ${speaker[@]+"${speaker[@]}"}
  speaker=("target/${PROGRAMS%% *}/release/vibro")
done
for target in $WHEELS; do
  "$python" packaging/wheel.py "$target" "$to"
done
"$python" packaging/smoke.py "$to"
