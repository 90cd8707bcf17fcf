#!/bin/bash
# Runs the program and expects it to refuse: exit code 1, every expected phrase
# in one line of standard error, nothing on standard output, no file touched.
#
# run_failure.sh FOLDER PHRASE [PHRASE...] -- PROGRAM [ARGUMENT...]
set -u
folder=$1
shift
phrases=()
while [ "$1" != "--" ]; do
  phrases+=("$1")
  shift
done
shift

# An output folder from an earlier run, whose content must survive.
rm -rf "$folder"
mkdir -p "$folder/output/scene"
echo "earlier results" >"$folder/output/scene/statistics.csv"
cd "$folder" || exit 1
fingerprint() { find . -type f -exec cksum {} + -o -type d -print | sort; }
before=$(fingerprint)
complete=$("$@" 2>&1 >/dev/null)
code=$?
# mpirun adds a note of its own about the exit code, in a frame of dashes.
message=$(sed '/^---/,$d' <<<"$complete")
after=$(fingerprint)

fail() {
  echo "FAILED: $1"
  echo "$complete"
  exit 1
}
[ "$code" = 1 ] || fail "exit code $code, expected 1"
[ "$before" = "$after" ] || fail "files were changed: $after"
[ "$(grep -c . <<<"$message")" = 1 ] || fail "expected one line of message"
[[ "$message" == "selkie: error: "* ]] || fail "expected 'selkie: error: ...'"
for phrase in "${phrases[@]}"; do
  [[ "$message" == *"$phrase"* ]] || fail "expected the words: $phrase"
done
echo "$message"
