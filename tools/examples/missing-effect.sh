#!/usr/bin/env bash
# The story of section VIII.C of Gnad et al. 2024 in one command: a spindle (drive 4) that the linear friction model cannot follow. A virtual
# robot whose drive 4 lacks friction at low speed is recorded fast, slowly, and once more for the proof; delta-diagnose finds what is
# missing, names it, adds it and shows the gap that it closes.
#   missing-effect.sh FOLDER     FOLDER must not exist, or be empty
# Uses the installed tools: those beside this script, else those on the PATH.
set -euo pipefail

. "$(dirname -- "${BASH_SOURCE[0]}")/study.bash"
start_study missing-effect.sh 6 "$@"

run "$bin/delta-model" create delta4 --base-radius 0.2 --platform-radius 0.05 --upper-arm 0.525 --strut 1.106 --strut-spacing 0.1 \
  --drive-range-rad "-0.9,1.6;-0.9,1.6;-0.9,1.6;-50,50" --drive-velocity-rad-s 6,6,6,48 --drive-acceleration-rad-s2 60,60,60,240 \
  -o "$out/robot.urdf"
run "$bin/delta-model" prior "$out/robot.urdf" -o "$out/truth.csv"
# Fast, slow, and one that takes no part; calm enough that rows are left between the reversals. A number of starts, not a time, so that every run plans the same.
seed=1
for speed in 48 6 24; do
  run "$bin/delta-excite" "$out/robot.urdf" -o "$out/motion$speed.csv" --workspace half-ball --workspace-center-m 0,0,-0.80 \
    --workspace-radius-m 0.3 --drive-velocity-rad-s "3,3,3,$speed" --drive-acceleration-rad-s2 20,20,20,200 --yaw-range-rad 40 \
    --base-frequency-hz 0.1,0.2 --starts 1 --time-limit-s 60 --seed $seed
  run "$bin/delta-simulate" "$out/robot.urdf" --params "$out/truth.csv" --trajectory "$out/motion$speed.csv" \
    --effect shear_thinning@drive4:friction=0.4,rate=2.5,exponent=0 --encoder-bits 19 --torque-noise-n-m 0.1,0.1,0.1,0.012 --seed $seed \
    -o "$out/log$speed.csv"
  seed=$((seed + 1))
done
judge "$bin/delta-identify" "$out/robot.urdf" "$out/log48.csv" "$out/log6.csv" -o "$out/params.csv" --report "$out/identification.html"
run "$bin/delta-diagnose" "$out/robot.urdf" --params "$out/params.csv" "$out/log48.csv" "$out/log6.csv" --holdout "$out/log24.csv" \
  -o "$out/diagnosis.csv" --effects-out "$out/effects.csv" --params-out "$out/improved.csv" --report "$out/diagnosis.html"
echo "report: $out/diagnosis.html"
