#!/usr/bin/env bash
# The release, on one machine with Linux, up to the upload: try.sh FOLDER
set -euo pipefail
mkdir -p "$1"
to=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."

packaging/check.py
# The library without the command. Alone: beside the Python module it would have all of its features.
cargo clippy --locked --release -p vibroimpact --lib --no-default-features -- -D warnings
python3 -m venv "$to/env"
"$to/env/bin/pip" --quiet --disable-pip-version-check install --requirement packaging/requirements.txt
export PATH="$to/env/bin:$PATH"
export PROGRAMS="x86_64-unknown-linux-musl aarch64-unknown-linux-musl"
export WHEELS="x86_64-unknown-linux-gnu aarch64-unknown-linux-gnu sdist"
packaging/build.sh "$to/dist"
packaging/formula.py "$to/dist" --partial
ls -l "$to/dist"
cargo publish --workspace --dry-run --locked
