#!/bin/sh
# Every file that a README of the tree links to is there.
#
#   links_test.sh ROOT
set -eu
cd -- "$1"
list=$(mktemp)
trap 'rm -f -- "$list"' EXIT
find . -name README.md -not -path './build/*' -not -path './out/*' -not -path './.git/*' | sort | while IFS= read -r readme; do
  grep -oE '\]\([^)#]+' "$readme" | sed 's/^](//' | grep -vE '^[a-z]+:' | while IFS= read -r link; do
    [ -e "$(dirname "$readme")/$link" ] || echo "$readme: no such file: $link"
  done
done >"$list"
if [ -s "$list" ]; then
  cat -- "$list"
  exit 1
fi
