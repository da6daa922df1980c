#include "../../../src/diagnosis/verdict/judge.hpp"

#include <gtest/gtest.h>

namespace deltadyn::detail {
namespace {

/// \param left  rms of the hold-out residual of both drives beside the names; none: no hold-out log
Diagnosis diagnosis(DiagnosisVerdict verdict, double share, std::vector<double> left = {}) {
  Diagnosis out;
  out.verdict = verdict;
  out.explained_share = share;
  double given = 1;  // the second drive is ten times as large, and counts as much
  for (const double rms : left) {
    out.holdout_figures.push_back({given, rms, 100, 100});
    given *= 10;
  }
  return out;
}

TEST(ExplainsMore, ANameGoesBeforeNoName) {
  const Diagnosis named = diagnosis(DiagnosisVerdict::confusable, 0.5);
  for (const DiagnosisVerdict none :
       {DiagnosisVerdict::nothing_missing, DiagnosisVerdict::unknown_structure, DiagnosisVerdict::not_testable}) {
    EXPECT_TRUE(explains_more(named, diagnosis(none, 0)));
    EXPECT_FALSE(explains_more(diagnosis(none, 0), named));
    EXPECT_FALSE(explains_more(diagnosis(none, 0), diagnosis(none, 0)));
  }
}

TEST(ExplainsMore, OfTwoNamesTheOneThatLeavesLessOfTheHoldOutLog) {
  const Diagnosis first = diagnosis(DiagnosisVerdict::named, 0.9, {0.2, 5}),
                  second = diagnosis(DiagnosisVerdict::named, 0.8, {0.3, 2});
  EXPECT_TRUE(explains_more(second, first));
  EXPECT_FALSE(explains_more(first, second));
}

TEST(ExplainsMore, WithoutHoldOutLogTheOneThatExplainsMoreOfTheStructure) {
  EXPECT_TRUE(explains_more(diagnosis(DiagnosisVerdict::named, 0.99), diagnosis(DiagnosisVerdict::named, 0.8)));
  EXPECT_FALSE(explains_more(diagnosis(DiagnosisVerdict::named, 0.8), diagnosis(DiagnosisVerdict::named, 0.8)));
}

}  // namespace
}  // namespace deltadyn::detail
