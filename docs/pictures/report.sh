#!/usr/bin/env bash
# The README's picture of a report, light and dark: a first diagnosis of a simulated robot, and its page in Chromium.
# usage: docs/pictures/report.sh      after cargo build --release; CHROMIUM names another browser
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
residyn=$here/../../target/release/residyn
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

"$residyn" simulate cases --only stribeck_friction --cases 1 --seed 3 --out sim --quiet
"$residyn" diagnose --robot sim/cases/*/robot.urdf --data sim/cases/*/train.parquet --heldout sim/cases/*/test.parquet --html gap.html
for scheme in dark light; do
    number=$([ $scheme = dark ] && echo 0 || echo 1)
    "${CHROMIUM:-chromium}" --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1100,1215 \
        --blink-settings=preferredColorScheme="$number" --screenshot="$work/$scheme.png" "file://$work/gap.html" >/dev/null 2>&1
    mv "$work/$scheme.png" "$here/report-$scheme.png"
done
