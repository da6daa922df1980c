#!/usr/bin/env bash
# Example 2 of Gnad et al. 2024 (section VIII): a virtual industrial robot with the parameters of Table I and a spindle whose
# friction the linear model cannot follow. Identified from a fast motion, checked on one whose spindle turns slowly, then mended by
# hand as the authors did. Ends with the path of the report.
#   industrial.sh FOLDER [--short]     FOLDER must not exist, or be empty; --short plans from fewer starts
# Uses the installed tools: those beside this script, else those on the PATH.
set -euo pipefail

. "$(dirname -- "${BASH_SOURCE[0]}")/study.bash"
start_study industrial.sh 6 "$@"
starts=8 # a number of starts, not a time, so that every run plans the same
if [ -n "$short" ]; then starts=1; fi

cp -- "$data/robots/irb360_6_1600.urdf" "$out/robot.urdf"
cp -- "$data/studies/industrial/plant.csv" "$data/studies/industrial/prior_simple.csv" \
  "$data/studies/industrial/prior_geometric.csv" "$out/"

# The drives give 60 N m; 50 by the prior leaves room for what the prior does not know.
# Largest rate and acceleration of the spindle: 2760 deg/s, 13.8e3 deg/s^2 to identify, 175 deg/s, 500 deg/s^2 to verify (VIII.C).
plan() {
  run "$bin/delta-excite" "$out/robot.urdf" -o "$out/$1.csv" --workspace half-ball --workspace-center-m 0,0,-0.80 \
    --workspace-radius-m 0.35 --drive-velocity-rad-s "6,6,6,$2" --drive-acceleration-rad-s2 "60,60,60,$3" --platform-velocity-m-s 4 \
    --platform-acceleration-m-s2 50 --yaw-velocity-rad-s "$2" --yaw-acceleration-rad-s2 "$3" --yaw-range-rad "$4" \
    --base-frequency-hz 0.1,0.3 --harmonics 5 --periodic --params "$out/prior_geometric.csv" \
    --drive-torque-n-m 50,50,50,4 --starts "$starts" --time-limit-s 600 --seed "$5"
}
plan fast 48.17 240.9 40 1
plan slow 3.054 8.727 3 2

# Deficit of friction at low speed; slow errors of the torque of the size that the paper's residuals have.
record() {
  run "$bin/delta-simulate" "$out/robot.urdf" --params "$out/plant.csv" --trajectory "$out/$1.csv" -o "$out/log_$1.csv" \
    --repeat "$2" --effect shear_thinning@drive4:friction=0.26,rate=1.7,exponent=0 --encoder-bits 19 \
    --torque-noise-n-m 2.0,1.7,2.2,0.15 --torque-noise-correlation 0.98 --seed "$3" --summary "$out/simulate_$1.csv"
}
record fast 4 1
record slow 2 2

# As the authors, we set the weight of the prior by hand: it holds what the motion does not show and costs no residual.
for prior in simple geometric; do
  judge "$bin/delta-identify" "$out/robot.urdf" "$out/log_fast.csv" --prior "$out/prior_$prior.csv" \
    -o "$out/identified_$prior.csv" --base "$out/base.csv" --cutoff-hz 20 --period-s none --regularization 1 --summary "$out/identify_$prior.csv" \
    --report "$out/identification_$prior.html"
done

# The base parameters as a parameter file: each stands for the parameter that leads its expression, all others are 0.
awk -F, 'NR == 1 { print "name,value,unit"; next } { name = $2; sub(/ .*/, "", name); print name "," $3 "," $4 }' "$out/base.csv" \
  >"$out/base_as_parameters.csv"
# By hand, as in VIII.C: five times the viscous, three quarters of the Coulomb friction of the spindle.
awk -F, -v OFS=, '$1 == "drive4.viscous" { $2 *= 5 } $1 == "drive4.coulomb" { $2 *= 0.75 } { print }' "$out/identified_geometric.csv" \
  >"$out/by_hand.csv"

for model in identified_simple identified_geometric base_as_parameters by_hand; do
  judge "$bin/delta-validate" "$out/robot.urdf" --params "$out/$model.csv" "$out/log_slow.csv" --cutoff-hz 20 --period-s none \
    -o "$out/residuals_$model.csv" --summary "$out/validate_$model.csv"
done

"$programs/industrial-study" "$out" --summary "$out/summary.csv"
