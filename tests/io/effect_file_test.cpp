#include "deltadyn/io/effect_file.hpp"

#include <gtest/gtest.h>

#include "deltadyn/runtime/error.hpp"

#include "io/temporary_folder.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

class EffectFile : public ::testing::Test {
 protected:
  std::string write(const std::string& text) { return folder_.write("effects.csv", text); }
  void refuses(const std::string& text, const std::string& part) {
    try {
      (void)read_effects(write(text), robot_);
      FAIL() << "accepted: " << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
  testing_support::TemporaryFolder folder_;
  RobotDescription robot_ = testing_support::delta_description("delta4");
};

TEST_F(EffectFile, ReadsBackWhatItWrote) {
  Effect stribeck;
  stribeck.id = effect_id<effects::Stribeck>;
  stribeck.joint = 1;
  stribeck.shape = Eigen::Vector2d(0.25, 2);
  stribeck.amplitude = Eigen::VectorXd::Constant(1, 2.0 / 3.0);
  stribeck.amplitude_std = Eigen::VectorXd::Constant(1, 0.01);
  Effect lag;
  lag.id = effect_id<effects::CurrentLag>;
  lag.joint = -1;
  lag.shape = Eigen::Vector2d(0.003, 1);
  lag.amplitude = Eigen::VectorXd::Constant(1, 0.003);
  const std::string path = folder_.path("out.csv");
  write_effects(path, {stribeck, lag}, robot_);
  const std::vector<Effect> read = read_effects(path, robot_);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].id, effect_id<effects::Stribeck>);
  EXPECT_EQ(read[0].joint, 1);
  EXPECT_EQ(read[0].amplitude(0), 2.0 / 3.0);
  EXPECT_EQ(read[0].amplitude_std(0), 0.01);
  EXPECT_EQ(read[0].shape, stribeck.shape);
  EXPECT_EQ(read[1].shape, lag.shape);
}

// Logs come in another order, or alone, in the next command: names hold where numbers would be wrong.
TEST_F(EffectFile, KeepsTheNamesOfTheLogsThatHaveALoad) {
  const auto effects = read_effects(write("effect,joint,parameter,value,unit\npayload,platform,mass,0.3,kg\npayload,"
                                          "platform,log,a/slow.csv;check.csv,\n"),
                                    robot_);
  ASSERT_EQ(effects.size(), 1u);
  EXPECT_EQ(effects[0].logs, (std::vector<std::string>{"slow.csv", "check.csv"}));
  write_effects(folder_.path("again.csv"), effects, robot_);
  EXPECT_EQ(read_effects(folder_.path("again.csv"), robot_)[0].logs, effects[0].logs);
  EXPECT_EQ(effects_in_log(effects, "here/check.csv", 1)[0].shape(0), 1);
  EXPECT_EQ(effects_in_log(effects, "slow.csv", 3)[0].shape(0), 3);
  EXPECT_EQ(effects_in_log(effects, "fast.csv", 1)[0].shape(0), -1);
}

TEST_F(EffectFile, TakesTheAliasAndTheBareNumberOfADrive) {
  const auto effects =
      read_effects(write("effect,joint,parameter,value,unit\ntorque_offset,3,offset,0.5,N*m\n"), robot_);
  ASSERT_EQ(effects.size(), 1u);
  EXPECT_EQ(effects[0].id, effect_id<effects::AsymmetricCoulomb>);
  EXPECT_EQ(effects[0].joint, 2);
}

TEST_F(EffectFile, RefusesSizesThatCannotBe) {
  const std::string header = "effect,joint,parameter,value,unit,std\n", rest = "stribeck,drive1,exponent,2,,\n";
  refuses(header + rest + "stribeck,drive1,rate,0.2,rad/s,\nstribeck,drive1,friction,-1,N*m,\n",
          "line 4, column value: friction of stribeck cannot be negative");
  refuses(header + rest + "stribeck,drive1,rate,0,rad/s,\nstribeck,drive1,friction,1,N*m,\n",
          "line 3, column value: rate of stribeck must be positive");
  refuses(header + "saturation,drive2,level,20,N*m,\nsaturation,drive2,share,1.5,,\n",
          "line 3, column value: share of saturation is 1.5, beyond its largest value");
  refuses(header + "hysteresis,drive1,torque,inf,N*m,\n", "line 2, column value: 'inf' is not a finite number");
}

TEST_F(EffectFile, RefusesWhatItDoesNotKnow) {
  const std::string header = "effect,joint,parameter,value,unit,std\n";
  refuses("# deltadyn effects 99\n" + header + "torque_offset,drive1,offset,1,N*m,\n", "version 99");
  refuses(header + "magic,drive1,offset,1,N*m,\n", "no effect 'magic'");
  refuses(header + "stribeck,drive7,friction,1,N*m,\n", "cannot act at 'drive7'");
  refuses(header + "stribeck,drive1,speed,1,N*m,\n", "no parameter 'speed'");
  refuses(header + "stribeck,drive1,friction,1,N,\n", "unit 'N'");
  refuses(header + "stribeck,drive1,friction,1,N*m,\n",
          "line 2: rate of stribeck at drive1 is missing\n  mend: add a row stribeck,drive1,rate,VALUE,rad/s,");
  refuses(header + "hose_force,drive1,force_x,1,N,\n",
          "line 2, column joint: the effect hose_force cannot act at 'drive1'");
  refuses(header + "torque_offset,drive1,offset,1,N*m,\ntorque_offset,drive1,offset,1,N*m,\n",
          "there twice, first in line 2");
  refuses("effect,joint,value,unit\n", "column 'parameter' is missing");
}

}  // namespace
}  // namespace deltadyn
