#!/bin/sh
# Builds the C++ peer into target/peers. Needs g++, Eigen (Debian: libeigen3-dev) and PyPI's `pin`, whose wheel
# carries Pinocchio's headers:  PYTHON=/path/to/python benches/peers/build.sh
set -e
here=$(cd "$(dirname "$0")" && pwd)
out=${CARGO_TARGET_DIR:-$here/../../target}/peers
prefix=$(${PYTHON:-python3} -c 'import cmeel, pathlib; print(pathlib.Path(cmeel.__file__).parent.parent / "cmeel.prefix")')
mkdir -p "$out"
g++ -std=c++17 -O3 -march=native -DNDEBUG -w \
  -DBOOST_MPL_LIMIT_LIST_SIZE=30 -DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS -DBOOST_FUSION_INVOKE_MAX_ARITY=12 \
  -I"$prefix/include" -I"${EIGEN:-/usr/include/eigen3}" \
  "$here/pinocchio.cpp" -o "$out/pinocchio"
echo "$out/pinocchio"
