#!/usr/bin/env bash
# Builds the wheel as `pip install ./python` does, and tests it in clean environments of the oldest and the newest Python here, without a Rust toolchain
# on the path. Needs a folder for its files: check.sh FOLDER
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(cd "$1" && pwd)

# Each Python from 3.10 on, one a minor version, the oldest first.
pythons() {
  local python
  for python in $(compgen -c python3. | grep -xE 'python3\.[0-9]+' | sort -u) "${PYENV_ROOT:-$HOME/.pyenv}"/versions/*/bin/python3; do
    "$python" -c 'import sys, venv; v = sys.version_info; v >= (3, 10) and print(v.minor, sys.executable)' 2>/dev/null || true
  done | sort -n -u -k1,1
}
mapfile -t all < <(pythons | cut -d' ' -f2)
[ "${#all[@]}" -ge 1 ] || { echo "no Python from 3.10 on is here"; exit 1; }
[ "${#all[@]}" -ge 2 ] || echo "only one Python from 3.10 on is here: the package is tested with that alone"

"${all[-1]}" -m pip --quiet wheel --no-deps --wheel-dir "$work/wheels" "$root/python"
wheel=$(ls "$work"/wheels/*.whl)
files=$("${all[-1]}" -m zipfile --list "$wheel")
for licence in MIT APACHE DejaVu uPlot; do
  grep -q "LICENSE-$licence" <<<"$files" || { echo "the wheel lacks LICENSE-$licence"; exit 1; }
done
echo "$(basename "$wheel"): $(($(stat -c %s "$wheel") / 1000)) kB"

# Tests one Python with what an extra of the wheel brings; all that it prints goes into a file.
try() {
  local python=$1 env=$2 extra=$3
  "$python" -m venv "$env"
  # Uncompiled: most modules of these packages are never imported.
  "$env/bin/pip" --quiet --disable-pip-version-check install --no-compile "$wheel[$extra]"
  cd "$env"
  export PATH="$env/bin:/usr/bin:/bin"
  ! command -v cargo rustc || { echo "a Rust toolchain is on the path"; return 1; }
  vibro --version
  python -m pytest -q -rs -p no:cacheprovider "$root/python/tests"
}
ends=("${all[0]}")
[ "${#all[@]}" -lt 2 ] || ends+=("${all[-1]}")
# The oldest runs every test; the newest leaves out those of Arrow, of a cluster and of the notebooks, whose packages fill half a gigabyte.
extras=(test-all test)
running=()
for k in "${!ends[@]}"; do
  (try "${ends[$k]}" "$work/env-$k" "${extras[$k]}") >"$work/env-$k.log" 2>&1 &
  running+=($!)
done
failed=0
for k in "${!ends[@]}"; do
  wait "${running[$k]}" || failed=1
  "${ends[$k]}" --version
  tail -n 40 "$work/env-$k.log"
done
[ "$failed" -eq 0 ] || exit 1
cd "$root/python" && "$work/env-0/bin/python" -m mypy --cache-dir "$work/mypy" vibroimpact
