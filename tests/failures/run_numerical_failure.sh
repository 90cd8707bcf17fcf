#!/bin/bash
# Runs a scene that cannot be solved as asked: exit code 2, the message on the
# screen and in the log, and the verdict in summary.json. If it fails in a step,
# it was tried again, and leaves a checkpoint that is marked good; if at the
# start, it says so, and there is nothing to go on from.
#
# run_numerical_failure.sh step|start FOLDER PHRASE PROGRAM [ARGUMENT...]
set -u
when=$1 folder=$2 phrase=$3
shift 3
rm -rf "$folder"
text=$("$@" --output "$folder" 2>&1)
code=$?

fail() {
  echo "FAILED: $1"
  echo "$text"
  exit 1
}
says() {
  grep -q "$2" "$folder/$1" || fail "$1 does not say: $2"
}
[ "$code" = 2 ] || fail "exit code $code, expected 2"
echo "$text" | grep -q "$phrase" || fail "the screen does not say: $phrase"
says log.txt "$phrase"
says summary.json "$phrase"
says summary.json '"verdict": "failure"'
if [ "$when" = start ]; then
  says log.txt "No step was tried"
  says summary.json '"steps": 0'
  [ ! -e "$folder/checkpoint" ] || fail "a checkpoint of nothing"
else
  says log.txt "trying again with a time step"
  [ -n "$(find "$folder/checkpoint" -mindepth 2 -type f)" ] || fail "no checkpoint"
fi
