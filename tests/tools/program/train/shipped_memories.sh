#!/bin/sh
# shipped_memories.sh PROGRAM SOURCE_DIR: the commands of detectors/hd/memories/README.md give the bytes that are there.
set -eu
program=$1
cd "$2"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" sweep scenes/benchmark/slip-1/learn_papillarray.yaml -o "$folder/learn.h5" --quiet
"$program" train "$folder/learn.h5" -o "$folder/cl_gst_hd" --json > "$folder/figures.json"
diff -r "$folder/cl_gst_hd" detectors/hd/memories/cl_gst_hd
