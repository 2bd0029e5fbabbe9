#!/usr/bin/env bash
# Builds a crate for WebAssembly, and prints the path of its module: build_wasm.sh CRATE PROFILE FOLDER
# Needs the target of the toolchain: rustup target add wasm32-unknown-unknown
set -euo pipefail
cd "$(dirname "$0")/.."

# No path of this machine may stand in the file.
home=${CARGO_HOME:-$HOME/.cargo}
export RUSTFLAGS="--remap-path-prefix=$home=cargo --remap-path-prefix=$PWD=vibroimpact"
cargo build --locked --quiet --profile "$2" --package "$1" --lib --target wasm32-unknown-unknown --target-dir "$3" >&2
echo "$PWD/$3/wasm32-unknown-unknown/$2/${1//-/_}.wasm"
