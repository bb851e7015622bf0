#!/bin/sh
# From recordings of a robot to a corrected model: check, identification, diagnosis. The drive file beside this script says what the
# robot's own log holds; docs/recipes.md says how to make that log.
#
# usage: diagnose.sh ROBOT DESCRIPTION TRAIN HELDOUT OUT [option of diagnose …]
#        ROBOT: ur5e, fr3, xarm, so101, iiwa; DESCRIPTION: its URDF or MJCF; RESIDYN: the program, if not on the path
set -eu
if [ $# -lt 5 ]; then
    sed -n 's/^# \{0,1\}//; 5,6p' "$0" >&2
    exit 2
fi
name=$1 robot=$2 train=$3 heldout=$4 out=${5%/}
shift 5
drive="$(dirname "$0")/$name.toml"
if [ ! -f "$drive" ]; then
    echo "error: there is no recipe $name; there are: $(cd "$(dirname "$0")" && echo *.toml)" >&2
    exit 2
fi
residyn=${RESIDYN:-residyn}
mkdir -p "$out"
"$residyn" train --robot "$robot" --drive "$drive" --data "$train" --check-only
"$residyn" train --robot "$robot" --drive "$drive" --data "$train" --heldout "$heldout" --physics-only --out "$out/model"
case $robot in *.xml) patch=corrected.xml ;; *) patch=corrected.urdf ;; esac
"$residyn" diagnose --robot "$robot" --drive "$drive" --data "$train" --heldout "$heldout" \
    --json "$out/gap.json" --html "$out/gap.html" --patch "$out/$patch" "$@"
