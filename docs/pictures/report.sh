#!/usr/bin/env bash
# The README's picture of a report, light and dark: `residyn demo` and its page in Chromium.
# usage: docs/pictures/report.sh      after cargo build --release; CHROMIUM names another browser, RESIDYN another program
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
residyn=${RESIDYN:-$here/../../target/release/residyn}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

"$residyn" demo
for scheme in dark light; do
    number=$([ $scheme = dark ] && echo 0 || echo 1)
    "${CHROMIUM:-chromium}" --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1100,1215 \
        --blink-settings=preferredColorScheme="$number" --screenshot="$work/$scheme.png" "file://$work/residyn-demo/gap.html" >/dev/null 2>&1
    mv "$work/$scheme.png" "$here/report-$scheme.png"
done
