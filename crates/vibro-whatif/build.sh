#!/usr/bin/env bash
# Builds the model of the report page for WebAssembly, packed as the page carries it, into the folder that is named, by default among the page's
# own files. Needs what build_wasm.sh needs.
set -euo pipefail
cd "$(dirname "$0")/../.."
to=$(realpath "${1:-src/report/assets/page}")
module=$(crates/build_wasm.sh vibro-whatif wasm target/whatif)
gzip -9 -n -c "$module" >"$to/whatif.wasm.gz"
sha256sum "$to/whatif.wasm.gz"
