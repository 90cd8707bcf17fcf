#!/bin/bash
# Runs a scene of which one file meets a full disk: exit code 1 and one message
# that names the file, soon and on any number of ranks.
#
# run_write_failure.sh FOLDER FILE PROGRAM [ARGUMENT...]
set -u
folder=$1 file=$2
shift 2
rm -rf "$folder"
mkdir -p "$folder/solution" "$folder/probes"
if [ "$file" != . ]; then
  ln -s /dev/full "$folder/$file"
fi
# FILE = .: the whole folder goes once the run is under way.
if [ "$file" = . ]; then
  (until [ -s "$folder/statistics.csv" ]; do sleep 0.1; done; rm -rf "$folder") &
fi
message=$(timeout 60 "$@" --output "$folder" 2>&1 >/dev/null)
code=$?

fail() {
  echo "FAILED: $1"
  echo "$message"
  exit 1
}
[ "$code" = 1 ] || fail "exit code $code, expected 1"
[ "$(grep -c '^selkie: error: ' <<<"$message")" = 1 ] || fail "expected one message"
[[ "$message" == *"cannot write"*"$folder/${file#.}"* ]] || fail "expected the file's name"
echo "$message" | grep '^selkie: error: '
