#!/usr/bin/env bash
# Try the .deb where nothing helps it: a bare Debian 13 without Python, with a virtual screen. `make try-bundle`.
# The folder that is tried is the one in the package; the scripts that try it are run by the program itself.
set -euo pipefail
BUILD=$1
HERE=$(dirname "$0")
ROOT=$BUILD/root
in_root() { "$HERE/../.ci/bare_root" run "$ROOT" "$@"; }

"$HERE/../.ci/bare_root" make "$ROOT" xvfb xauth
mkdir -p "$ROOT/try"
cp "$BUILD"/trisect_*.deb "$HERE"/try_*.py "$ROOT/try/"
in_root sh -c '! command -v python3' >/dev/null
in_root sh -ec 'apt-get install -y -qq --no-install-recommends /try/trisect_*.deb >/dev/null; rm /try/trisect_*.deb'
in_root sh -ec '! command -v python3 >/dev/null; command -v trisect; trisect --version; du -sm /opt/trisect'

in_root trisect --module /try/try_libraries.py

in_root trisect --module /try/try_processes.py
in_root sh -ec 'NUMBA_CACHE_DIR=/try/cache trisect demo --out /try/demo'
in_root sh -ec 'export NUMBA_CACHE_DIR=/try/cache TRISECT_SHOT=/try/window.png; \
    xvfb-run -a -s "-screen 0 1920x1080x24" trisect-workbench --module /try/try_window.py'

compiled=$(find "$ROOT/try/cache" -type f ! -name complete | wc -l)   # that mark says nothing was left to compile
echo "functions compiled: $compiled"
[ "$compiled" = 0 ]

"$BUILD/venv/bin/python" "$HERE/start_ratio.py"
