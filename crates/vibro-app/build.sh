#!/usr/bin/env bash
# Builds the page `vibro.html`, one file with the whole tool, into the folder that is named. Needs Python 3, and what build_wasm.sh needs.
set -euo pipefail
cd "$(dirname "$0")/../.."
to=$(realpath "${1:?the folder for vibro.html}")
module=$(crates/build_wasm.sh vibro-app app target/app)
unpacker=$(crates/build_wasm.sh vibro-unpack app target/app)
"$(command -v python3 || command -v python)" crates/vibro-app/pack.py "$module" "$unpacker" "$to/vibro.html"
