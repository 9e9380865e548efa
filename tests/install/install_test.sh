#!/bin/sh
# Installs Repose to a fresh prefix, then builds and runs another CMake project against it.
#
#   install_test.sh BUILD_TREE SOURCE_TREE [CMAKE_OPTION...]
set -eu
build=$1
source=$2
shift 2
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
prefix=$scratch/prefix

cmake --install "$build" --prefix "$prefix" >"$scratch/install.log" || {
  cat "$scratch/install.log"
  exit 1
}
cp -R "$source/tests/install/consumer" "$scratch/consumer"
cmake -S "$scratch/consumer" -B "$scratch/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$prefix" "$@"
cmake --build "$scratch/build"
"$scratch/build/ball_rests"

# Nothing of the installed package may point back into the trees it was built from.
if grep -rlF -e "$build" -e "$source" "$prefix/include" "$prefix"/lib*/cmake "$prefix"/lib*/*/cmake 2>/dev/null; then
  echo 'these installed files name the build or source tree'
  exit 1
fi
if [ -x "$prefix/bin/repose" ]; then
  cd -- "$scratch"
  "$prefix/bin/repose" --version
fi
