#pragma once

/// \file
/// Where good ends and bad begins. Each limit has its reason; they are judgements of engineering, not of the
/// mathematics.

namespace deltadyn {

/// Residual over rms torque. Feed-forward that leaves a twentieth to the feedback loop is what a good industrial drive
/// with its scatter of friction and its torque ripple allows; beyond a sixth or so, friction fitted alone often does as
/// well.
inline constexpr double kGoodResidual = 0.05;
inline constexpr double kUsableResidual = 0.15;

/// A residual up to this many times the noise of the torque record is a matter of the record, not of the model.
inline constexpr double kNoiseOfRecord = 1.5;

/// A dependence of the residual on the motion that chance gives less often than once in a hundred logs ...
inline constexpr double kRareByChance = 0.01;
/// ... and that explains a tenth of its mean square is worth telling ...
inline constexpr double kNotableShare = 0.10;
/// ... and worth acting on if this part is above one fiftieth of the torque: less is lost in the change of friction as
/// a machine warms up.
inline constexpr double kRelevantStructure = 0.02;

/// Rows that tell as much as one of white noise. Above it the residual has a memory, and is no measurement noise.
inline constexpr double kNoticeableMemory = 3.0;

/// Physical consistency may cost this much of the residual of free base parameters before the two contradict each
/// other.
inline constexpr double kCheapConsistency = 1.02;
inline constexpr double kDearConsistency = 1.10;

/// Standard deviation of the model torque over its rms, on any motion in the workspace.
inline constexpr double kWellKnownTorque = 0.02;
inline constexpr double kKnownTorque = 0.10;

/// Condition number of the scaled regressor: textbooks ask for about 100 (Gautier, Khalil 1992); above 1000 three of
/// the digits that the log holds are lost.
inline constexpr double kGoodCondition = 100;
inline constexpr double kHighCondition = 1000;

/// Relative standard deviation of a base parameter: up to a tenth well seen, beyond 30 % hardly (Khalil, Dombre 2002,
/// ch. 12).
inline constexpr double kWellSeen = 0.10;
inline constexpr double kPoorlySeen = 0.30;

/// Data share: at 0.9 the data have cut the prior's standard deviation to a third, below 0.5 they have not even cut it
/// to 70 %.
inline constexpr double kDataDecides = 0.9;
inline constexpr double kPriorDecides = 0.5;

/// A parameter that makes less than this share of any drive's torque is not worth another recording.
inline constexpr double kNegligibleEffect = 0.01;
/// Beyond this many standard deviations from the prior, the prior does not hold a value.
inline constexpr double kHeldByPrior = 3.0;

/// Rows near velocity reversals that may be left out: of a log that loses more than two thirds, the figures speak for
/// the lesser part of the motion only. Whether the rest tells enough is not asked here but by the uncertainty of the
/// torque.
inline constexpr double kFewMasked = 0.67;
/// A share of left-out rows that is no matter: the rows about the start of each log, before the first reversal.
inline constexpr double kNoMatterMasked = 0.02;
/// Residual near reversals over that elsewhere, from which on friction there is another law. As in identify().
inline constexpr double kOtherLaw = 3.0;

/// Largest deviation of a base parameter between the consistent fit and least squares that goes without remark [std].
inline constexpr double kRemarkableDeviation = 3.0;

/// A fit that is proven to within this in chi^2 is as good as the best one for all that the noise lets us know.
inline constexpr double kNoiseInChiSquare = 1.0;

}  // namespace deltadyn
