#pragma once

/// \file
/// The thresholds by which the diagnosis decides. The numbers were set on the tuning cases of the blind study
/// (tests/studies) and on measured drives; a study can vary them one by one (DiagnosisOptions::policy).

namespace deltadyn {

/// Shares are of 1. "Noise variance" is that of a drive's torque in the rows of the search, beside everything that the
/// motion explains.
struct DiagnosisPolicy {
  // --- which rows are used ---
  double rest_share = 0.03;          ///< of a joint's largest rate in all logs: below, friction is that of rest
  double rest_share_of_slow = 0.12;  ///< at most so much of a slow log's own largest rate, which must show something
  double bristle_holds = 1.5;        ///< rms near reversals over the floor, up to which a known bristle is believed
  double rows_per_parameter = 4;     ///< independent rows of a drive for each base parameter, else: too short
  double widest_cutoff_hz = 25;      ///< above, encoder noise in accelerations outweighs the rows that are gained
  double wider_band = 1.4;           ///< ratio of cut-offs from which a wider band is worth a search of its own

  // --- what counts as an effect ---
  double noisy_column = 0.75;      ///< share of encoder noise in a column's squares, above which it shows nothing
  double provisional_gain = 20;    ///< rise of twice the log-likelihood that keeps an effect out of the noise model
  double material = 0.02;          ///< of the noise variance: a smaller first effect is of no use to anybody
  double material_further = 0.15;  ///< the same beside another effect, whose form leaves something
  double exchange_worth = 2.0;     ///< lead in worth by which another name takes the place of one taken before
  double hygiene_samples = 1.0;    ///< a delay up to this is a matter of who samples when

  // --- which effects cannot be told apart ---
  double set_likelihood = 3.0;  ///< standard deviations of the likelihood ratio within which two are one set
  double set_bootstrap = 2.0;   ///< the same by blocks of the log
  double set_form = 0.02;       ///< share of a gain by which the forms of the catalogue tell nothing
  double as_good = 0.9;         ///< share of a gain from which a simpler effect does as well
  double clear_share = 0.2;     ///< of a gain on drives that no other effect reaches: enough to decide by

  // --- what the form of a named effect leaves elsewhere (its own shares stand in its header) ---
  double form_elsewhere = 0.03;  ///< at another place
  double form_other = 0.01;      ///< there, for effects that depend on something else
  double form_anywhere = 1e-4;   ///< for any effect, as parameters carry errors to all drives
  double stands_out = 3.0;       ///< gain over the best of all other classes, from which it is no error of form
  double reached = 0.05;         ///< of an effect's squares: a drive with less is not reached

  // --- the verdict ---
  double structure_chance = 0.002;   ///< of structure on clean logs, below which it counts
  double material_structure = 0.3;   ///< of the noise variance: structure without a name
  double explained = 0.8;            ///< of the structure, that names must explain
  double hardly_explained = 0.4;     ///< less says that a name is wrong even where the hold-out log does not show it
  double explained_by_many = 0.985;  ///< the same of several names, which together follow much that is none of them
  double closed = 0.5;               ///< of the gap on the hold-out log, that names must close
  double closed_of_little = 0.25;    ///< the same of a gap hardly above the floor, or whose interval reaches `closed`
  double holdout_gap = 1.4;          ///< rms over floor from which a hold-out log contradicts a model without a name
  double overt_floor = 1.1;          ///< rms over floor of a drive, from which something is plainly missing
  double slow_torque = 175;          ///< residual over record noise, times residual over torque against other drives
  double resonance = 0.8;            ///< of the cut-off: the law of a spring holds below its resonance

  // --- friction that bends, from slow logs ---
  double unsure_course = 0.15;  ///< standard deviation of the size, from which its course is open
  double slow_logs = 0.25;      ///< of a drive's velocity limit: logs below are slow
  double course_ends = 3.5;     ///< times the rate of the bend: logs that reach it show where it ends
  double other_speed = 1.5;     ///< ratio of two logs' largest rates from which they show different courses

  // --- the proof on the hold-out log, through the path of delta-validate ---
  double clearly_better = 0.98;  ///< rms as written over as given, at most
  double worse = 1.05;           ///< from which a named drive is worse; also the least gap that counts as one
  double worse_elsewhere = 1.2;  ///< of any other drive, whose parameters are fitted along, if it loses ...
  double loss_elsewhere = 0.01;  ///< ... this share of what the named drives gain in mean square: a tenth in rms
};

}  // namespace deltadyn
