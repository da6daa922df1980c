#include "deltadyn/io/model_export.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gmock/gmock.h>
#include <tinyxml2.h>

#include "deltadyn/firmware/effect_refusal.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"

#include "support/descriptions.hpp"
#include "support/matchers.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

/// A delta4 with every kind of column, nominal bodies, and numbers that can be told apart.
struct Sample {
  RobotDescription description = delta_description("delta4");
  std::unique_ptr<Robot> robot = make_robot(description, {false, true, {1, 4}, true});
  Eigen::VectorXd p = nominal_parameters(*robot, PartShapes(description)).value;

  [[nodiscard]] double& at(const std::string& name) {
    const auto& names = robot->parameter_names();
    return p(std::find(names.begin(), names.end(), name) - names.begin());
  }
  Sample() {
    for (int k = 0; k < p.size(); ++k) {
      const std::string& name = robot->parameter_names()[static_cast<std::size_t>(k)];
      if (name.find("offset") != std::string::npos) p(k) = 0;
    }
    at("drive1.viscous") = 1.25;
    at("drive1.coulomb") = 3.5;
    at("telescope.coulomb") = 4.25;
    at("drive1.rotor_inertia") = 0.0625;
    at("drive4.rotor_inertia") = 0.03125;
  }
};

TEST(ModelExport, CarriesFrictionRotorAndOffsetToMujoco) {
  Sample sample;
  sample.at("drive2.offset") = 0.75;
  const ExportedModel model = export_mjcf(*sample.robot, sample.p);
  EXPECT_THAT(model.left_out, IsEmpty());
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.Parse(model.text.c_str()), tinyxml2::XML_SUCCESS);
  EXPECT_THAT(model.text, HasSubstr("damping=\"1.25\" frictionloss=\"3.5\" armature=\"0.0625\""));
  EXPECT_THAT(model.text, HasSubstr("frictionloss=\"4.25\""));
  EXPECT_THAT(model.text, HasSubstr("armature=\"0.03125\""));
  EXPECT_THAT(model.text,
              HasSubstr("<general name=\"drive2\" joint=\"drive2\" biastype=\"affine\" biasprm=\"-0.75 0 0\""));
  EXPECT_THAT(model.text, HasSubstr("<motor name=\"drive1\" joint=\"drive1\"/>"));
}

TEST(ModelExport, GivesARobotFileAgainAsUrdf) {
  Sample sample;
  const ExportedModel model = export_urdf(*sample.robot, sample.p);
  EXPECT_THAT(model.text, HasSubstr("<dynamics damping=\"1.25\" friction=\"3.5\"/>"));
  const RobotDescription back = robot_from_urdf(model.text, "export");
  EXPECT_EQ(back.type, "delta4");
  EXPECT_THAT(back.limbs[1].p_WD, IsNear(sample.description.limbs[1].p_WD, 1e-12));
}

// The arm's inertia about the drive, from the file, is the identified one and the rotor's.
TEST(ModelExport, PutsTheRotorOnTheAxisInUrdf) {
  Sample sample;
  tinyxml2::XMLDocument document;
  const std::string text = export_urdf(*sample.robot, sample.p).text;
  ASSERT_EQ(document.Parse(text.c_str()), tinyxml2::XML_SUCCESS);
  const auto* link = document.FirstChildElement("robot")->FirstChildElement("link");
  while (link != nullptr && std::string(link->Attribute("name")) != "upper_arm1")
    link = link->NextSiblingElement("link");
  ASSERT_NE(link, nullptr);
  const auto* inertial = link->FirstChildElement("inertial");
  const double m = inertial->FirstChildElement("mass")->DoubleAttribute("value");
  double x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(inertial->FirstChildElement("origin")->Attribute("xyz"), "%lf %lf %lf", &x, &y, &z), 3);
  const double Iyy = inertial->FirstChildElement("inertia")->DoubleAttribute("iyy") + m * (x * x + z * z);
  EXPECT_NEAR(m, sample.at("upper_arm.m"), 1e-12);
  EXPECT_NEAR(Iyy, sample.at("upper_arm.Iyy") + 0.0625, 1e-12);
}

/// All amplitudes and shapes alike.
Effect effect_of(const char* name, int joint, double amplitude, double shape = 0.5) {
  const EffectKind& kind = *find_effect_kind(name);
  Effect effect;
  effect.id = kind.id;
  effect.joint = joint;
  effect.amplitude = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(kind.amplitudes.size()), amplitude);
  effect.shape = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(kind.shapes.size()), shape);
  return effect;
}

TEST(ModelExport, ListsWhatItLeavesOut) {
  Sample sample;
  sample.at("drive2.offset") = 0.75;
  const Effect stribeck = effect_of("stribeck", 1, 2.0), rotor = effect_of("rotor_inertia", 0, 1.0);
  const ExportedModel mjcf = export_mjcf(*sample.robot, sample.p, {stribeck, rotor});
  ASSERT_THAT(mjcf.left_out, SizeIs(1));
  EXPECT_THAT(mjcf.left_out[0],
              AllOf(HasSubstr("effect stribeck at drive2"), HasSubstr("friction, offsets and rotors only")));
  EXPECT_THAT(mjcf.text, AllOf(HasSubstr(mjcf.left_out[0]), HasSubstr("armature=\"1.0625\"")));
  const ExportedModel urdf = export_urdf(*sample.robot, sample.p, {stribeck});
  ASSERT_THAT(urdf.left_out, SizeIs(3));  // the effect, the offset, the loops for plain readers
  EXPECT_THAT(urdf.text, HasSubstr("drive2.offset = 0.75"));
}

TEST(ModelExport, HandsEffectsToTheController) {
  Sample sample;
  sample.at("drive2.offset") = 0.75;
  const ExportedModel none = export_header(*sample.robot, sample.p, {effect_of("rotor_inertia", 0, 1.0)});
  EXPECT_EQ(none.effects, 0);
  EXPECT_THAT(none.left_out, IsEmpty());
  EXPECT_THAT(none.text, AllOf(HasSubstr("1.0625,  // drive1.rotor_inertia"), HasSubstr("0.75,  // drive2.offset"),
                               HasSubstr("<deltadyn/firmware/feed_forward.hpp>"), Not(HasSubstr("kEffects"))));
  const ExportedModel some = export_header(*sample.robot, sample.p,
                                           {effect_of("stribeck", 1, 2.0), effect_of("stribeck", 0, 3.0),
                                            effect_of("hose_force", -1, 4.0), effect_of("rotor_inertia", 0, 1.0)});
  EXPECT_EQ(some.effects, 3);
  EXPECT_THAT(some.left_out, IsEmpty());
  EXPECT_THAT(
      some.text,
      AllOf(HasSubstr("<deltadyn/firmware/effect_feed_forward.hpp>"), HasSubstr("kEffectCount = 3;"),
            HasSubstr("    // stribeck at drive2\n    //   friction 2 N*m\n    //   rate=0.5 rad/s; exponent=0.5\n"
                      "    {deltadyn::effect_named(\"stribeck\"), 1, {0.5, 0.5},\n     {2}},\n"),
            HasSubstr("SomeEffects<deltadyn::effect_named(\"stribeck\"), deltadyn::effect_named(\"hose_force\")>"),
            HasSubstr("{deltadyn::effect_named(\"hose_force\"), -1, {},\n     {4, 4, 4, 4, 4, 4}}")));
}

TEST(ModelExport, SaysWhyAControllerCannotTakeAnEffect) {
  Sample sample;
  const std::pair<Effect, EffectRefusal> rows[] = {
      {effect_of("current_lag", -1, 1e-3), EffectRefusal::of_the_record},
      {effect_of("joint_elasticity", 0, 1e-3), EffectRefusal::spring},
      {effect_of("payload", -1, 1.0, 1), EffectRefusal::of_one_log},
      {effect_of("stribeck", 4, 1.0), EffectRefusal::no_such_place},
      {effect_of("stribeck", 0, 1.0, 1e-60), EffectRefusal::bad_number},  // 0 in float
  };
  for (const auto& [effect, refusal] : rows) {
    const ExportedModel header = export_header(*sample.robot, sample.p, {effect});
    EXPECT_EQ(header.effects, 0);
    ASSERT_THAT(header.left_out, SizeIs(1));
    EXPECT_THAT(header.left_out[0],
                AllOf(HasSubstr(std::string(effect_kind(effect.id).name)), HasSubstr(message(refusal))));
    EXPECT_THAT(header.text, AllOf(HasSubstr(header.left_out[0]), Not(HasSubstr("kEffects"))));
  }
  const ExportedModel many =
      export_header(*sample.robot, sample.p, std::vector<Effect>(70, effect_of("stribeck", 0, 0.1)));
  EXPECT_EQ(many.effects, 64);
  ASSERT_THAT(many.left_out, SizeIs(6));
  EXPECT_THAT(many.left_out[5], HasSubstr(message(EffectRefusal::no_room)));
}

TEST(ModelExport, GivesARobotWithoutToolABodyThatTurns) {
  const RobotDescription description = delta_description("delta4");
  const auto robot = make_robot(description, {false, false, {}, false});
  const Eigen::VectorXd p = nominal_parameters(*robot, PartShapes(description)).value;
  const std::string text = export_mjcf(*robot, p).text;
  EXPECT_THAT(text, HasSubstr("<body name=\"tool\""));
  EXPECT_THAT(export_urdf(*robot, p).text, Not(HasSubstr("nan")));
}

TEST(ModelExport, KnowsEveryType) {
  for (const auto& description : {delta_description("delta3"), delta_description("linear-delta3"),
                                  axis_description(DriveKind::revolute), axis_description(DriveKind::prismatic)}) {
    const auto robot = make_robot(description);
    Eigen::VectorXd p = nominal_parameters(*robot, PartShapes(description)).value;
    p(0) = 2;
    EXPECT_THAT(export_mjcf(*robot, p).text, HasSubstr("<motor name=\"drive1\""));
    EXPECT_THAT(export_urdf(*robot, p).text, HasSubstr("<inertial>"));
    EXPECT_THAT(export_header(*robot, p).text, HasSubstr("feed_forward()"));
  }
}

/// The joint that leads the plate, by its range; null if no joint of the plate has one.
const tinyxml2::XMLElement* joint_with_range(const tinyxml2::XMLElement* body, double range) {
  for (auto* joint = body->FirstChildElement("joint"); joint != nullptr; joint = joint->NextSiblingElement("joint")) {
    double low = 0, high = 0;
    if (joint->Attribute("range") != nullptr && std::sscanf(joint->Attribute("range"), "%lf %lf", &low, &high) == 2 &&
        std::abs(high - range) < 1e-9 && std::abs(low + range) < 1e-9)
      return joint;
  }
  for (auto* inner = body->FirstChildElement("body"); inner != nullptr; inner = inner->NextSiblingElement("body"))
    if (const auto* found = joint_with_range(inner, range); found != nullptr) return found;
  return nullptr;
}

TEST(ModelExport, KeepsThePlateInItsRangeInMujoco) {
  for (const char* type : {"h4", "i4", "par4"}) {
    const RobotDescription description = four_limb_description(type);
    const auto robot = make_robot(description);
    const ExportedModel model = export_mjcf(*robot, nominal_parameters(*robot, PartShapes(description)).value);
    tinyxml2::XMLDocument document;
    ASSERT_EQ(document.Parse(model.text.c_str()), tinyxml2::XML_SUCCESS);
    // Bars swing as far as the plate turns; the halves of an I4 slide apart by twice the pinion radius times that.
    const PlateShape& plate = *description.plate;
    const double range = plate.range * (plate.pinion_radius > 0 ? 2 * plate.pinion_radius : 1);
    const auto* world = document.FirstChildElement("mujoco")->FirstChildElement("worldbody");
    EXPECT_NE(joint_with_range(world, range), nullptr) << type << "\n" << model.text;
  }
}

TEST(ModelExport, RefusesBodiesThatCannotBe) {
  Sample sample;
  Eigen::VectorXd negative = sample.p, thin = sample.p, broken = sample.p;
  negative(0) = -1;
  thin(4) = 100;  // Ixx of the arm without Iyy or Izz to match
  broken(3) = std::nan("");
  EXPECT_THROW((void)export_mjcf(*sample.robot, negative), Error);
  EXPECT_THROW((void)export_urdf(*sample.robot, negative), Error);
  EXPECT_THROW((void)export_mjcf(*sample.robot, thin), Error);
  EXPECT_THROW((void)export_header(*sample.robot, broken), Error);
  EXPECT_THROW((void)export_header(*sample.robot, Eigen::VectorXd::Ones(3)), Error);
}

}  // namespace
}  // namespace deltadyn
