#!/bin/sh
# shipped_memories.sh PROGRAM SOURCE_DIR: the commands of detectors/hd/memories/README.md give the bytes that are there.
set -eu
program=$1
cd "$2"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" sweep scenes/papillarray/hexapod.yaml -o "$folder/hexapod.h5" --quiet
"$program" train "$folder/hexapod.h5" -o "$folder/cl_gst_hd" --json > "$folder/figures.json"
diff -r "$folder/cl_gst_hd" detectors/hd/memories/cl_gst_hd
