#!/bin/sh
# shipped_memories.sh PROGRAM SOURCE_DIR: the commands of detectors/hd/memories/README.md give the bytes that are there, seen.txt apart.
set -eu
program=$1
cd "$2"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" sweep scenes/benchmark/slip-1/learn_papillarray.yaml -o "$folder/learn.h5" --quiet
"$program" train "$folder/learn.h5" --all -o "$folder/cl_gst_hd" --json > "$folder/figures.json"
diff -r -x seen.txt "$folder/cl_gst_hd" detectors/hd/memories/cl_gst_hd
"$program" sweep scenes/learn/papillarray.yaml --set sweep.trials=60 \
  "sweep.motion.start={draw: uniform, min: 0.7 s, max: 2.6 s}" -o "$folder/slides.h5" --quiet
"$program" sweep scenes/learn/grasp.yaml --trials 150 -o "$folder/grasps.h5" --quiet \
  --set "sensors={pad: {type: papillarray, rate: 1 kHz, electronics: typical, device: redrawn}}"
"$program" train "$folder/slides.h5" --with "$folder/grasps.h5" --all --labels micro --epochs 3 --score -o "$folder/learn_gst_hd" --json > "$folder/figures.json"
diff -r -x seen.txt "$folder/learn_gst_hd" detectors/hd/memories/learn_gst_hd
