#!/bin/sh
# shipped_memories.sh PROGRAM SOURCE_DIR NAME: the commands of detectors/hd/memories/README.md give the bytes that are there.
set -eu
program=$1 name=$3
cd "$2"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
case $name in
  cl_gst_hd) scene="scenes/benchmark/slip-1/learn_papillarray.yaml" options="" ;;
  slip_gst_hd) scene="scenes/learn/papillarray.yaml --set sweep.trials=60" options="--labels strict --epochs 5" ;;
esac
"$program" sweep $scene -o "$folder/learn.h5" --quiet
"$program" train "$folder/learn.h5" $options -o "$folder/$name" --json > "$folder/figures.json"
diff -r "$folder/$name" "detectors/hd/memories/$name"
