#!/usr/bin/env bash
# Example 1 of Gnad et al. 2024 (section VII): identify a model whose parameters are known exactly, from two priors, with and
# without noise, and compare the terms of its equations of motion. Ends with the path of the report.
#   surrogate.sh FOLDER [--short]      FOLDER must not exist, or be empty; --short plans from fewer starts
# Uses the installed tools: those beside this script, else those on the PATH.
set -euo pipefail

. "$(dirname -- "${BASH_SOURCE[0]}")/study.bash"
start_study surrogate.sh 5 "$@"
starts=8 # a number of starts, not a time, so that every run plans the same
if [ -n "$short" ]; then starts=1; fi

cp -- "$data/robots/mujoco_delta4.urdf" "$out/robot.urdf"
cp -- "$data/studies/surrogate/nominal.csv" "$out/nominal.csv"
cp -- "$data/studies/surrogate/prior_below.csv" "$out/prior1.csv"
cp -- "$data/studies/surrogate/prior_above.csv" "$out/prior2.csv"

# The spindle has a friction of 4 N m here (paper, VII), so it turns slowly.
run "$bin/delta-excite" "$out/robot.urdf" -o "$out/trajectory.csv" --workspace half-ball --workspace-center-m 0,0,-0.80 \
  --workspace-radius-m 0.35 --drive-velocity-rad-s 6,6,6,12 --drive-acceleration-rad-s2 60,60,60,120 --platform-velocity-m-s 4 \
  --platform-acceleration-m-s2 50 --yaw-velocity-rad-s 12 --yaw-acceleration-rad-s2 120 --yaw-range-rad 10 \
  --base-frequency-hz 0.1,0.3 --harmonics 5 --periodic --starts "$starts" --time-limit-s 600

# Noise-free: exact motion and the torque that it takes.
run "$bin/delta-simulate" "$out/robot.urdf" --params "$out/nominal.csv" --trajectory "$out/trajectory.csv" --inverse \
  -o "$out/log_exact.csv" --summary "$out/simulate_exact.csv"
for k in 1 2; do
  judge "$bin/delta-identify" "$out/robot.urdf" "$out/log_exact.csv" --no-filter --prior "$out/prior$k.csv" \
    -o "$out/identified$k.csv" --base "$out/base$k.csv" --summary "$out/identify$k.csv"
done

# Torque noise of 1 % of each drive's largest torque; the motion still exact, eight runs.
noise="$(awk -F, '/^largest_torque_drive/ { printf "%s%.6g", (n++ ? "," : ""), 0.01 * $2 }' "$out/simulate_exact.csv")"
run "$bin/delta-simulate" "$out/robot.urdf" --params "$out/nominal.csv" --trajectory "$out/trajectory.csv" --repeat 8 --inverse \
  --torque-noise-n-m "$noise" -o "$out/log_noise.csv" --summary "$out/simulate_noise.csv"
for k in 1 2; do
  judge "$bin/delta-identify" "$out/robot.urdf" "$out/log_noise.csv" --no-filter --prior "$out/prior$k.csv" \
    -o "$out/identified${k}_noise.csv" --summary "$out/identify${k}_noise.csv"
done

# As a real robot would record it: closed loop, encoders of 19 bit, the same noise; rates and accelerations from the tools' filters.
run "$bin/delta-simulate" "$out/robot.urdf" --params "$out/nominal.csv" --trajectory "$out/trajectory.csv" --repeat 8 --discard-s 0.5 \
  --encoder-bits 19 --torque-noise-n-m "$noise" -o "$out/log_closed.csv" --summary "$out/simulate_closed.csv"
for k in 1 2; do
  judge "$bin/delta-identify" "$out/robot.urdf" "$out/log_closed.csv" --period-s none --cutoff-hz 60 --prior "$out/prior$k.csv" \
    -o "$out/identified${k}_closed.csv" --summary "$out/identify${k}_closed.csv" --report "$out/identification${k}_closed.html"
done

"$programs/surrogate-study" "$out" "$out/robot.urdf" "$out/nominal.csv" --summary "$out/summary.csv"
