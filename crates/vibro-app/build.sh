#!/usr/bin/env bash
# Builds the page `vibro.html`, one file with the whole tool, into the folder that is named. Needs Python 3 and the target of the toolchain:
# rustup target add wasm32-unknown-unknown
set -euo pipefail
cd "$(dirname "$0")/../.."
to=$(realpath "${1:?the folder for vibro.html}")

# No path of this machine may stand in the file.
home=${CARGO_HOME:-$HOME/.cargo}
export RUSTFLAGS="--remap-path-prefix=$home=cargo --remap-path-prefix=$PWD=vibroimpact"
cargo build --locked --quiet --profile app --package vibro-app --lib --target wasm32-unknown-unknown --target-dir target/app
"$(command -v python3 || command -v python)" crates/vibro-app/pack.py target/app/wasm32-unknown-unknown/app/vibro_app.wasm "$to/vibro.html"
