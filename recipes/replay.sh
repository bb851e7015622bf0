#!/bin/sh
# From commands and encoders to a corrected model, without torque. The drive file in the folder replay beside this script says what the robot's own log
# holds; docs/recipes.md says how to make that log.
#
# usage: replay.sh ROBOT DESCRIPTION TRAIN HELDOUT OUT [option of replay …]
#        ROBOT: so101, so101_table, koch, z1, piper; DESCRIPTION: its URDF or MJCF; RESIDYN: the program, if not on the path
set -eu
if [ $# -lt 5 ]; then
    sed -n 's/^# \{0,1\}//; 5,6p' "$0" >&2
    exit 2
fi
name=$1 robot=$2 train=$3 heldout=$4 out=${5%/}
shift 5
here=$(dirname "$0")/replay
drive=$here/$name.toml
if [ ! -f "$drive" ]; then
    echo "error: there is no recipe $name; there are: $(cd "$here" && echo *.toml)" >&2
    exit 2
fi
mkdir -p "$out"
case $robot in *.xml) patch=corrected.xml ;; *) patch=corrected.urdf ;; esac
"${RESIDYN:-residyn}" replay --robot "$robot" --drive "$drive" --data "$train" --heldout "$heldout" \
    --json "$out/gap.json" --html "$out/gap.html" --patch "$out/$patch" "$@"
