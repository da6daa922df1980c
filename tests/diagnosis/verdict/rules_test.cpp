// The table of rules row by row: facts that each row decides, and facts beside them that it must leave to others.

#include "../../../src/diagnosis/verdict/rules.hpp"

#include <gtest/gtest.h>
#include <set>

namespace deltadyn::detail {
namespace {

const DiagnosisPolicy kPolicy;

VerdictReason reason(const VerdictFacts& facts) {
  return deciding_rule(facts, kPolicy).reason;
}

DiagnosisVerdict verdict(const VerdictFacts& facts) {
  return deciding_rule(facts, kPolicy).verdict;
}

/// One name that explains all, proved on the hold-out log.
VerdictFacts one_name() {
  VerdictFacts facts;
  facts.names = 1;
  facts.explained_share = 0.99;
  facts.holdout_gap = 2;
  facts.gap_closed = facts.gap_closed_at_most = 0.98;
  facts.overt = true;
  facts.written = WrittenModelIs::better;
  return facts;
}

TEST(VerdictRules, ANameThatHoldsIsNamed) {
  EXPECT_EQ(reason(one_name()), VerdictReason::one_name_fits);
  VerdictFacts facts = one_name();
  facts.written = WrittenModelIs::not_tried;  // before the proof
  EXPECT_EQ(verdict(facts), DiagnosisVerdict::named);
}

TEST(VerdictRules, WithASetItIsConfusable) {
  VerdictFacts facts = one_name();
  facts.sets = true;
  EXPECT_EQ(reason(facts), VerdictReason::several_names_fit);
  EXPECT_EQ(verdict(facts), DiagnosisVerdict::confusable);
}

TEST(VerdictRules, NothingFoundIsNothingMissing) {
  EXPECT_EQ(reason({}), VerdictReason::nothing_counts);
  EXPECT_EQ(verdict({}), DiagnosisVerdict::nothing_missing);
}

TEST(VerdictRules, ANameForAPartOfLargeStructureIsAGuess) {
  VerdictFacts facts = one_name();
  facts.structure_left = 2 * kPolicy.material_further;
  facts.explained_share = 0.9 * kPolicy.hardly_explained;
  EXPECT_EQ(reason(facts), VerdictReason::names_explain_too_little);
  facts.structure_left = 0.5 * kPolicy.material_further;  // what is left is too small to matter
  EXPECT_EQ(reason(facts), VerdictReason::one_name_fits);
}

TEST(VerdictRules, SeveralNamesMustExplainNearlyAll) {
  VerdictFacts facts = one_name();
  facts.structure_left = 2 * kPolicy.material_further;
  facts.explained_share = 0.95;
  EXPECT_EQ(reason(facts), VerdictReason::one_name_fits);
  facts.names = 2;
  EXPECT_EQ(reason(facts), VerdictReason::names_explain_too_little);
}

TEST(VerdictRules, StructureThatCountsNeedsNamesThatExplainIt) {
  VerdictFacts facts;
  facts.structure_counts = true;
  EXPECT_EQ(reason(facts), VerdictReason::structure_without_name);
  facts = one_name();
  facts.structure_counts = true;
  EXPECT_EQ(reason(facts), VerdictReason::one_name_fits);
  facts.explained_share = 0.9 * kPolicy.explained;
  EXPECT_EQ(reason(facts), VerdictReason::structure_without_name);
}

TEST(VerdictRules, NamesThatDoNotHelpTheHoldOutLogAreNone) {
  VerdictFacts facts = one_name();
  facts.gap_closed = facts.gap_closed_at_most = 0.9 * kPolicy.closed;
  EXPECT_EQ(reason(facts), VerdictReason::holdout_contradicts_names);
  facts.overt = false;
  EXPECT_EQ(reason(facts), VerdictReason::nothing_counts);
  facts.holdout_gap = 1.01;  // of a gap that is hardly one, less is asked
  EXPECT_EQ(reason(facts), VerdictReason::one_name_fits);
  facts.gap_closed = -0.1;
  EXPECT_EQ(reason(facts), VerdictReason::nothing_counts);
}

TEST(VerdictRules, AHoldOutLogThatCannotTellDoesNotContradict) {
  VerdictFacts facts = one_name();
  facts.holdout_gap = 1.06;
  facts.gap_closed = 0.3;
  facts.gap_closed_at_most = 0.9 * kPolicy.closed;
  EXPECT_EQ(reason(facts), VerdictReason::holdout_contradicts_names);
  facts.gap_closed_at_most = 1.4;
  EXPECT_EQ(reason(facts), VerdictReason::one_name_fits) << "the proof of what is written decides";
  facts.written = WrittenModelIs::no_better;
  EXPECT_EQ(reason(facts), VerdictReason::written_model_refused);
  facts.gap_closed = 0.9 * kPolicy.closed_of_little;
  EXPECT_EQ(reason(facts), VerdictReason::holdout_contradicts_names);
}

TEST(VerdictRules, NamesThatLeaveTwiceAsMuchThereAsInTrainingMustCloseMostOfTheGap) {
  VerdictFacts facts = one_name();
  facts.gap_closed = 0.7;
  EXPECT_EQ(reason(facts), VerdictReason::one_name_fits);
  facts.holdout_left = 1.1 * kPolicy.holdout_gap * kPolicy.holdout_gap;
  EXPECT_EQ(reason(facts), VerdictReason::holdout_contradicts_names);
  facts.gap_closed = 0.9;
  EXPECT_EQ(reason(facts), VerdictReason::one_name_fits);
}

TEST(VerdictRules, ASlowTorqueIsUnknownUnlessItIsNamed) {
  VerdictFacts facts;
  facts.slow_drive = 1;
  EXPECT_EQ(reason(facts), VerdictReason::slow_torque);
  facts = one_name();
  facts.slow_drive = 1;
  EXPECT_EQ(reason(facts), VerdictReason::one_name_fits);
  facts.open_courses = 1;
  EXPECT_EQ(reason(facts), VerdictReason::slow_torque);
}

TEST(VerdictRules, AnOpenCourseIsNotTestable) {
  VerdictFacts facts = one_name();
  facts.open_courses = 1;
  EXPECT_EQ(reason(facts), VerdictReason::course_open);
  EXPECT_EQ(verdict(facts), DiagnosisVerdict::not_testable);
  facts.names = 2;  // the other one is not open
  EXPECT_EQ(reason(facts), VerdictReason::one_name_fits);
}

TEST(VerdictRules, AHoldOutLogElsewhereIsNotTestableWithoutAName) {
  VerdictFacts facts;
  facts.missed_drive = 0;
  EXPECT_EQ(reason(facts), VerdictReason::holdout_moves_elsewhere);
  facts = one_name();
  facts.missed_drive = 0;
  EXPECT_EQ(reason(facts), VerdictReason::one_name_fits);
}

TEST(VerdictRules, HiddenBaseParametersAreNotTestableWithoutAName) {
  VerdictFacts facts;
  facts.base_hidden = true;
  EXPECT_EQ(reason(facts), VerdictReason::base_parameters_hidden);
  EXPECT_EQ(verdict(facts), DiagnosisVerdict::not_testable);
}

TEST(VerdictRules, WhatWouldBeWrittenMustBeBetter) {
  VerdictFacts facts = one_name();
  facts.written = WrittenModelIs::no_better;
  EXPECT_EQ(reason(facts), VerdictReason::written_model_refused);
  EXPECT_EQ(verdict(facts), DiagnosisVerdict::unknown_structure);
  facts.overt = false;
  EXPECT_EQ(reason(facts), VerdictReason::not_borne_out);
  EXPECT_EQ(verdict(facts), DiagnosisVerdict::nothing_missing);
  facts.written = WrittenModelIs::not_testable;
  EXPECT_EQ(reason(facts), VerdictReason::holdout_too_short);
  EXPECT_EQ(verdict(facts), DiagnosisVerdict::not_testable);
}

// Every reason but the one that is told before any rule is tried stands in one row; the last row always holds.
TEST(VerdictRules, TheTableIsComplete) {
  std::set<VerdictReason> seen;
  for (const VerdictRule& rule : verdict_rules()) EXPECT_TRUE(seen.insert(rule.reason).second);
  EXPECT_EQ(seen.count(VerdictReason::logs_too_short), 0U);
  EXPECT_EQ(static_cast<int>(seen.size()), static_cast<int>(VerdictReason::one_name_fits));
  EXPECT_TRUE(verdict_rules().back().holds({}, kPolicy));
}

}  // namespace
}  // namespace deltadyn::detail
