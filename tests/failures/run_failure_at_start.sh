#!/bin/bash
# Runs a scene whose first state cannot be computed: exit code 2, the reason and
# what to do in the log and on the screen, the verdict in summary.json, and no
# checkpoint, for there is nothing to go on from.
#
# run_failure_at_start.sh FOLDER PHRASE PROGRAM [ARGUMENT...]
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
for where in "$folder/log.txt" "$folder/summary.json"; do
  grep -q "$phrase" "$where" || fail "$where does not say: $phrase"
done
echo "$text" | grep -q "$phrase" || fail "the screen does not say: $phrase"
grep -q "No step was tried" "$folder/log.txt" || fail "log.txt does not say what to do"
grep -q '"verdict": "failure"' "$folder/summary.json" || fail "summary.json: no verdict"
grep -q '"steps": 0' "$folder/summary.json" || fail "summary.json: steps"
[ ! -e "$folder/checkpoint" ] || fail "a checkpoint of nothing"
