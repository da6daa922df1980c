#include "../../../src/diagnosis/verdict/describe.hpp"

#include <gtest/gtest.h>

namespace deltadyn::detail {
namespace {

ConsideredEffect considered(const std::string& name, Ruling ruling, const std::string& other = "") {
  ConsideredEffect out;
  out.name = name;
  out.joint = "drive1";
  out.ruling = ruling;
  out.other = other;
  return out;
}

EffectCandidate candidate(const std::string& name) {
  EffectCandidate out;
  out.name = name;
  out.joint = "drive1";
  return out;
}

// The first of a set was dropped, and another of it is named in its place.
TEST(SettleRulings, SaysWhatHoldsAtTheEnd) {
  Diagnosis out;
  out.verdict = DiagnosisVerdict::confusable;
  NamedEffect named;
  static_cast<EffectCandidate&>(named) = candidate("stribeck");
  named.confusable = {candidate("shear_thinning")};
  out.named = {named};
  out.considered = {
      considered("convex_viscous", Ruling::found), considered("stribeck", Ruling::like_another, "convex_viscous"),
      considered("shear_thinning", Ruling::like_another, "convex_viscous"),
      considered("hysteresis", Ruling::like_another, "convex_viscous"), considered("backlash", Ruling::no_evidence)};
  settle_rulings(out);
  EXPECT_EQ(out.considered[0].ruling, Ruling::not_confirmed);
  EXPECT_EQ(out.considered[1].ruling, Ruling::found);
  EXPECT_EQ(out.considered[2].ruling, Ruling::like_another);
  EXPECT_EQ(out.considered[2].other, "stribeck");
  EXPECT_EQ(out.considered[3].ruling, Ruling::not_confirmed);
  EXPECT_EQ(out.considered[4].ruling, Ruling::no_evidence);
}

TEST(SettleRulings, WhatIsNotNamedIsNotConfirmedOrDenied) {
  Diagnosis out;
  out.verdict = DiagnosisVerdict::unknown_structure;
  for (const auto& [reason, ruling] : {std::pair(VerdictReason::structure_without_name, Ruling::not_confirmed),
                                       std::pair(VerdictReason::written_model_refused, Ruling::holdout_denies)}) {
    out.reason = reason;
    out.considered = {considered("stribeck", Ruling::found)};
    settle_rulings(out);
    EXPECT_EQ(out.considered[0].ruling, ruling);
  }
}

}  // namespace
}  // namespace deltadyn::detail
