#include <gtest/gtest.h>

#include "../../src/diagnosis/diagnosis_steps.hpp"

namespace deltadyn::detail {
namespace {

ConsideredEffect considered(const std::string& name, const std::string& ruling) {
  ConsideredEffect out;
  out.name = name;
  out.joint = "drive1";
  out.ruling = ruling;
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
  const std::string like = kLikeAnother;
  out.considered = {considered("convex_viscous", kFound), considered("stribeck", like + "convex_viscous"),
                    considered("shear_thinning", like + "convex_viscous"),
                    considered("hysteresis", like + "convex_viscous"), considered("backlash", "no evidence")};
  settle_rulings(out);
  EXPECT_EQ(out.considered[0].ruling, "fits, but is not confirmed");
  EXPECT_EQ(out.considered[1].ruling, kFound);
  EXPECT_EQ(out.considered[2].ruling, like + "stribeck");
  EXPECT_EQ(out.considered[3].ruling, "fits, but is not confirmed");
  EXPECT_EQ(out.considered[4].ruling, "no evidence");
}

TEST(SettleRulings, LeavesThemWhereNothingIsNamed) {
  Diagnosis out;
  out.verdict = DiagnosisVerdict::unknown_structure;
  out.considered = {considered("stribeck", kFound)};
  settle_rulings(out);
  EXPECT_EQ(out.considered[0].ruling, kFound);
}

}  // namespace
}  // namespace deltadyn::detail
