#!/bin/bash
# Runs a scene that cannot be solved as asked: exit code 2, the message in the
# log, a checkpoint that is marked good, and the verdict in summary.json.
#
# run_numerical_failure.sh FOLDER PHRASE PROGRAM [ARGUMENT...]
set -u
folder=$1 phrase=$2
shift 2
rm -rf "$folder"
text=$("$@" --output "$folder" 2>&1)
code=$?

fail() {
  echo "FAILED: $1"
  echo "$text"
  exit 1
}
[ "$code" = 2 ] || fail "exit code $code, expected 2"
grep -q "$phrase" "$folder/log.txt" || fail "log.txt does not say: $phrase"
grep -q "trying again with a time step" "$folder/log.txt" || fail "no retry"
grep -q "$phrase" "$folder/summary.json" || fail "summary.json does not say: $phrase"
[ -n "$(find "$folder/checkpoint" -mindepth 2 -type f)" ] || fail "no checkpoint"
