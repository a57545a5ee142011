#!/bin/sh
# shipped_memories.sh PROGRAM SOURCE_DIR NAME: the commands of detectors/hd/memories/README.md
# reproduce the stored bytes of the classifier NAME, except seen.txt and the operating point: that of
# learn_gst_hd was chosen by the delay of the alarm, as --score of version 0.3.0 did.
set -eu
program=$1
name=$3
cd "$2"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
case $name in
  cl_gst_hd)
    "$program" sweep scenes/benchmark/slip-1/learn_papillarray.yaml -o "$folder/learn.h5" --quiet
    "$program" train-hd "$folder/learn.h5" --all -o "$folder/$name" --json > "$folder/figures.json"
    ;;
  learn_gst_hd)
    # The electronics of version 0.2, with which the memories were trained.
    electronics="[{coupling: {shear_to_normal: 0, normal_to_shear: 0.042, shear_to_shear: 0}}, gain, offset, drift, noise]"
    "$program" sweep scenes/learn/papillarray.yaml --set sweep.trials=60 \
      "sweep.motion.start={draw: uniform, min: 0.7 s, max: 2.6 s}" \
      "sweep.sensors.pad.electronics={draw: choice, values: [ideal, $electronics, $electronics]}" -o "$folder/slides.h5" --quiet
    "$program" sweep scenes/learn/undisturbed_grasp.yaml --trials 150 -o "$folder/grasps.h5" --quiet \
      --set "sensors={pad: {type: papillarray, rate: 1 kHz, electronics: $electronics, device: redrawn}}"
    "$program" train-hd "$folder/slides.h5" --with "$folder/grasps.h5" --all --labels micro --epochs 3 --score -o "$folder/$name" --json > "$folder/figures.json"
    ;;
esac
diff -r -x seen.txt -I '^on: ' -I '^off: ' "$folder/$name" "detectors/hd/memories/$name"
