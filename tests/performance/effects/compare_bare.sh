#!/bin/bash
# The bare scene gives the same digits in the program that has no other effect.
#
# compare_bare.sh SELKIE SELKIE_BARE SCENE
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$1" "$3" --output "$folder/all" >"$folder/all.txt"
"$2" "$3" --output "$folder/bare" >"$folder/bare.txt"
cmp "$folder/all/statistics.csv" "$folder/bare/statistics.csv"
# and that program knows nothing else
! "$2" "$3" --output "$folder/no" --set 'Effects=inertia, gravity' 2>"$folder/no.txt"
grep -q "there is no effect 'gravity'; allowed are any of: inertia$" "$folder/no.txt" ||
  { cat "$folder/no.txt"; exit 1; }
