#!/usr/bin/env bash
# Builds the model of the report page for WebAssembly, packed as the page carries it, into the folder that is named, by default among the page's
# own files. Needs the target of the toolchain: rustup target add wasm32-unknown-unknown
set -euo pipefail
cd "$(dirname "$0")/../.."
to=$(realpath "${1:-src/report/assets/page}")

# No path of this machine may stand in the file.
home=${CARGO_HOME:-$HOME/.cargo}
export RUSTFLAGS="--remap-path-prefix=$home=cargo --remap-path-prefix=$PWD=vibroimpact"
cargo build --locked --quiet --profile wasm --package vibro-whatif --lib --target wasm32-unknown-unknown --target-dir target/whatif
gzip -9 -n -c target/whatif/wasm32-unknown-unknown/wasm/vibro_whatif.wasm >"$to/whatif.wasm.gz"
sha256sum "$to/whatif.wasm.gz"
