// Every way to feed the tools files they cannot use: each has its message, its exit code, and leaves nothing behind.

#include "acceptance/bad_input.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn::acceptance {
namespace {

using W = Workshop;

// Columns of the log: 0 t_s, 1 to 4 the positions, 5 to 8 the torques.

void each_row(Lines& lines, const std::function<void(std::size_t, std::vector<std::string>&)>& change) {
  for (std::size_t k = 2; k <= lines.size(); ++k) {
    auto fields = fields_of(lines[k - 1]);
    change(k, fields);
    lines[k - 1] = join(fields);
  }
}

/// A row of exact states at rest: what --no-filter takes. Columns t_s, q, qd, qdd, tau of `drives` drives.
Lines states(int drives, const std::vector<double>& q, int rows = 200) {
  Lines lines(1, "t_s");
  for (const auto& [name, unit] : {std::pair{"q", "rad"}, {"qd", "rad_s"}, {"qdd", "rad_s2"}, {"tau", "Nm"}}) {
    for (int j = 1; j <= drives; ++j) lines[0] += fmt::format(",{}{}_{}", name, j, unit);
  }
  for (int k = 0; k < rows; ++k) {
    std::string line = fmt::format("{}", 0.001 * k);
    for (int j = 0; j < drives; ++j) line += fmt::format(",{}", q[static_cast<std::size_t>(j)]);
    for (int j = 0; j < 3 * drives; ++j) line += fmt::format(",{}", j < 2 * drives ? 0.0 : 1.0);
    lines.push_back(line);
  }
  return lines;
}

std::string without(const Lines& lines, const std::string& from, const std::string& to) {
  std::string text;
  bool inside = false, found = false;
  for (const std::string& line : lines) {
    if (line.find(from) != std::string::npos) inside = found = true;
    if (!inside) text += line + "\n";
    if (line.find(to) != std::string::npos) inside = false;
  }
  if (!found) throw std::runtime_error("no " + from);
  return text;
}

constexpr const char* kSerialArm = R"(<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/><link name="one"/><link name="two"/>
  <joint name="drive1" type="revolute"><parent link="base"/><child link="one"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="drive2" type="revolute"><parent link="one"/><child link="two"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>
)";

std::vector<Row> files() {
  return {
      {"MissingLog",
       [](const W& w) { return w.identify(w.path("no.csv")); },
       3,
       {"no\\.csv", "cannot open", "mend: check the path"}},
      {"MissingRobot", [](const W& w) { return w.identify("", w.path("no.urdf")); }, 3, {"no\\.urdf", "mend:"}},
      {"MissingPrior",
       [](const W& w) { return w.identify("", "", w.path("no.csv")); },
       3,
       {"no\\.csv", "cannot open", "mend:"}},
      {"MissingParameters",
       [](const W& w) { return w.validate("", "", w.path("no.csv")); },
       3,
       {"no\\.csv", "cannot open", "mend:"}},
      {"FolderAsLog", [](const W& w) { return w.identify(w.folder()); }, 3, {"folder, not a file", "mend:"}},
      {"FolderAsRobot", [](const W& w) { return w.info(w.folder()); }, 3, {"folder|directory", "mend:"}},
      {"EmptyLog",
       [](const W& w) { return w.identify(w.write("bad.csv", "")); },
       3,
       {"bad\\.csv", "the file is empty", "mend:"}},
      {"EmptyRobot",
       [](const W& w) { return w.identify("", w.write("bad.urdf", "")); },
       3,
       {"bad\\.urdf", "the file is empty", "mend:"}},
      {"EmptyPrior",
       [](const W& w) { return w.identify("", "", w.write("bad.csv", "")); },
       3,
       {"bad\\.csv", "the file is empty", "mend:"}},
      {"LogOfHeaderOnly",
       [](const W& w) { return w.identify(w.log("bad.csv", [](Lines& l) { l.resize(1); })); },
       3,
       {"bad\\.csv", "a header but no data rows", "mend:"}},
      {"PriorOfHeaderOnly",
       [](const W& w) { return w.identify("", "", w.prior("bad.csv", [](Lines& l) { l.resize(1); })); },
       3,
       {"bad\\.csv", "a header but no data rows", "mend:"}},
      {"NoHeader",
       [](const W& w) { return w.identify(w.log("bad.csv", [](Lines& l) { l.erase(l.begin()); })); },
       3,
       {"bad\\.csv, line 1", "header line is missing", "mend: .*column names"}},
      {"WrongHeaderPosition",
       [](const W& w) { return w.identify(w.log("bad.csv", [](Lines& l) { l[0] = replaced(l[0], "q2_rad", "q2"); })); },
       3,
       {"bad\\.csv", "column q2_rad is missing; the file has q2", "mend: name the column q2_rad or q2_deg"}},
      {"WrongHeaderTime",
       [](const W& w) {
         return w.validate(w.log("bad.csv", [](Lines& l) { l[0] = replaced(l[0], "t_s", "time_ms"); }));
       },
       3,
       {"bad\\.csv", "time column 'time_ms' \\[ms\\] the rows are 1e-06 s apart", "mend: .*t_s"}},
      {"WrongHeaderTorque",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) { l[0] = replaced(l[0], "tau3_Nm", "current3_A"); }));
       },
       3,
       {"bad\\.csv", "column tau3_Nm is missing", "mend:"}},
      {"WrongHeaderPrismatic",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) { l[0] = replaced(l[0], "q1_rad", "q1_m"); }));
       },
       3,
       {"bad\\.csv", "q1_m, which is for a prismatic drive", "mend:"}},
      {"ColumnTwice",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) { l[0] = replaced(l[0], "q2_rad", "q1_rad"); }));
       },
       3,
       {"bad\\.csv, line 1", "q1_rad occurs twice", "mend:"}},
      {"WrongHeaderPrior",
       [](const W& w) {
         return w.identify("", "", w.prior("bad.csv", [](Lines& l) { l[0] = "parameter,value,unit"; }));
       },
       3,
       {"bad\\.csv", "column name is missing", "mend:"}},
      {"TooFewFields",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) { l[39] = l[39].substr(0, l[39].rfind(',')); }));
       },
       3,
       {"bad\\.csv, line 40", "8 fields where the header has 9", "mend:"}},
      {"TooManyFields",
       [](const W& w) { return w.identify(w.log("bad.csv", [](Lines& l) { l[39] += ",1"; })); },
       3,
       {"bad\\.csv, line 40", "10 fields where the header has 9", "mend:"}},
      {"DecimalComma",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) {
           for (std::size_t k = 1; k < l.size(); ++k) std::replace(l[k].begin(), l[k].end(), '.', ',');
         }));
       },
       3,
       {"bad\\.csv, line 2", "fields where the header has 9", "mend:"}},
      {"TextInNumber",
       [](const W& w) { return w.identify(w.log("bad.csv", [](Lines& l) { set_field(l, 51, 7, "1.2Nm"); })); },
       3,
       {"bad\\.csv, line 51, column tau3_Nm", "'1\\.2Nm' is not a number", "mend:"}},
      {"TextInPrior",
       [](const W& w) {
         return w.identify("", "", w.prior("bad.csv", [](Lines& l) { set_field(l, 5, 1, "about 1"); }));
       },
       3,
       {"bad\\.csv, line 5, column value", "'about 1' is not a number", "mend:"}},
      {"NanInPrior",
       [](const W& w) { return w.identify("", "", w.prior("bad.csv", [](Lines& l) { set_field(l, 5, 1, "nan"); })); },
       3,
       {"bad\\.csv, line 5, column value", "not a finite number", "mend:"}},
      {"BinaryLog",
       [](const W& w) { return w.identify(w.write("bad.csv", std::string("MATLAB\0\1\2,a\n1,2\n", 17))); },
       3,
       {"bad\\.csv", "zero bytes", "mend:"}},
      {"BadSecondLog",
       [](const W& w) {
         Words words = w.identify();
         words.insert(words.begin() + 3, w.log("second.csv", [](Lines& l) { set_field(l, 51, 2, "x"); }));
         return words;
       },
       3,
       {"second\\.csv, line 51, column q2_rad", "mend:"}},
      {"LogOfSmallerRobot",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) {
           for (std::string& line : l) {
             auto f = fields_of(line);
             f.erase(f.begin() + 8);
             f.erase(f.begin() + 4);
             line = join(f);
           }
         }));
       },
       3,
       {"bad\\.csv", "column q4_rad is missing", "mend: .*robot file that fits"}},
  };
}

std::vector<Row> times() {
  return {
      {"NanTime",
       [](const W& w) { return w.identify(w.log("bad.csv", [](Lines& l) { set_field(l, 300, 0, "nan"); })); },
       3,
       {"bad\\.csv, line 300, column t_s", "not finite", "mend:"}},
      {"NanEverywhere",
       [](const W& w) {
         return w.validate(w.log("bad.csv", [](Lines& l) { each_row(l, [](std::size_t, auto& f) { f[3] = "nan"; }); }));
       },
       3,
       {"bad\\.csv, line 2, column q3_rad", "holds no number", "mend:"}},
      {"TimeInMilliseconds",
       [](const W& w) {
         return w.identify(
             w.log("bad.csv", [](Lines& l) { each_row(l, [](std::size_t k, auto& f) { f[0] = std::to_string(k); }); }));
       },
       3,
       {"bad\\.csv, line 2, column t_s", "samples are 1 s apart", "mend: give the time in seconds"}},
      {"ManyMissing",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) {
           for (std::size_t k = 100; k < 1490; k += 3) set_field(l, k, 5, "nan");
         }));
       },
       3,
       {"bad\\.csv, line 100", "% of the samples are missing", "mend:"}},
  };
}

std::vector<Row> motions() {
  return {
      {"StuckEncoder",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) {
           for (std::size_t k = 401; k < 700; ++k) set_field(l, k, 2, fields_of(l[399])[2]);
         }));
       },
       3,
       {"bad\\.csv, line 40[01], column q2_rad", "stuck encoder", "mend: check the encoder"}},
      {"LostCounts",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) {
           each_row(l, [](std::size_t k, auto& f) {
             if (k >= 600) f[4] = fmt::format("{}", std::stod(f[4]) + 0.4);
           });
         }));
       },
       3,
       {"bad\\.csv, line [56][0-9][0-9], column q4_rad", "position jumps", "mend: unwrap"}},
      {"TooShort",
       [](const W& w) { return w.identify(w.log("bad.csv", [](Lines& l) { l.resize(31); })); },
       3,
       {"bad\\.csv", "too short: 30 samples", "mend: record at least"}},
      {"TooShortForFilter",
       [](const W& w) {
         Words words = w.identify(w.log("bad.csv", [](Lines& l) { l.resize(601); }));
         words.back() = "4";
         return words;
       },
       3,
       {"bad\\.csv", "too short for a cut-off of 4 Hz", "mend:.*(cut-off|record)"}},
      {"NothingMoves",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) {
           const auto first = fields_of(l[1]);
           each_row(l, [&](std::size_t, auto& f) { std::copy(first.begin() + 1, first.begin() + 5, f.begin() + 1); });
         }));
       },
       3,
       {"bad\\.csv", "nothing moves", "mend: record a motion"}},
      {"OneDriveMoves",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) {
           const auto first = fields_of(l[1]);
           each_row(l, [&](std::size_t, auto& f) { std::copy(first.begin() + 1, first.begin() + 4, f.begin() + 1); });
         }));
       },
       5,
       {"does not excite every base parameter", "says nothing about .*[a-z_]+[0-9]*\\.[A-Za-z]+",
        "mend: record a motion"}},
      {"TorqueNotRecorded",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) { each_row(l, [](std::size_t, auto& f) { f[7] = "0"; }); }));
       },
       3,
       {"bad\\.csv, line 2, column tau3_Nm", "torque is always 0", "mend:"}},
      {"TorqueCutOff",
       [](const W& w) {
         return w.identify(w.log("bad.csv", [](Lines& l) {
           each_row(l, [](std::size_t, auto& f) { f[5] = fmt::format("{}", std::clamp(std::stod(f[5]), -3.0, 3.0)); });
         }));
       },
       3,
       {"bad\\.csv, line [0-9]+, column tau1_Nm", "cut off", "mend:"}},
      {"OutOfReach",
       [](const W& w) {
         succeed(create_delta3(w.path("small.urdf"), 0.2, 0.05, 0.525, 0.55));
         return w.validate("", w.path("small.urdf"));
       },
       3,
       {"log\\.csv, line [0-9]+", "out of reach at drive positions", "mend: check that the robot file belongs"}},
      {"OutOfReachWithoutFilter",
       [](const W& w) {
         succeed(create_delta3(w.path("small.urdf"), 0.2, 0.05, 0.525, 0.55));
         return w.validate(w.write("bad.csv", states(3, {0.1, 0.05, 0})), w.path("small.urdf")) + Words{"--no-filter"};
       },
       3,
       {"bad\\.csv, line 2", "out of reach", "mend:"}},
      {"SingularPose",
       [](const W& w) {
         succeed(create_delta3(w.path("flat.urdf"), 0.2, 0.05, 0.525, 0.675 + 1e-14));
         return w.validate(w.write("bad.csv", states(3, {0, 0, 0})), w.path("flat.urdf")) + Words{"--no-filter"};
       },
       3,
       {"bad\\.csv, line 2", "singular", "mend:"}},
      {"NoVelocities",
       [](const W& w) { return w.validate() + Words{"--no-filter"}; },
       3,
       {"log\\.csv", "column qd1_rad_s is missing", "mend:"}},
  };
}

std::vector<Row> priors() {
  return {
      {"NegativeMass",
       [](const W& w) { return w.identify("", "", w.prior_with("bad.csv", "upper_arm.m", "-1.1")); },
       3,
       {"bad\\.csv", "upper_arm", "mass -1\\.1 kg is negative", "mend:"}},
      {"NegativeMassOfPoint",
       [](const W& w) { return w.identify("", "", w.prior_with("bad.csv", "platform.m", "-0.2")); },
       3,
       {"bad\\.csv", "platform", "mass -0\\.2 kg is (negative|not positive)", "mend:"}},
      {"BrokenTriangle",
       [](const W& w) { return w.identify("", "", w.prior_with("bad.csv", "telescope_upper.Izz", "5")); },
       3,
       {"bad\\.csv", "telescope_upper", "triangle inequality", "mend:"}},
      {"MomentTooLarge",
       [](const W& w) { return w.identify("", "", w.prior_with("bad.csv", "upper_arm.mcx", "3")); },
       3,
       {"bad\\.csv", "upper_arm", "first moments are too large", "mend:"}},
      {"NegativeFriction",
       [](const W& w) { return w.identify("", "", w.prior_with("bad.csv", "drive2.coulomb", "-2")); },
       3,
       {"bad\\.csv", "drive2\\.coulomb", "negative", "mend:"}},
      {"UnitMismatch",
       [](const W& w) { return w.identify("", "", w.prior("bad.csv", [](Lines& l) { set_field(l, 2, 2, "g"); })); },
       3,
       {"bad\\.csv, line 2, column unit", "unit 'g' does not fit upper_arm\\.m", "mend: give the value in kg"}},
      {"UnitOfOtherDrive",
       [](const W& w) {
         return w.validate("", "", w.prior("bad.csv", [](Lines& l) {
           for (std::string& line : l) {
             if (line.rfind("drive1.coulomb", 0) == 0) line = "drive1.coulomb,1,N";
           }
         }));
       },
       3,
       {"bad\\.csv, line [0-9]+, column unit", "unit 'N' does not fit drive1\\.coulomb", "mend:"}},
      {"ParameterTwice",
       [](const W& w) { return w.identify("", "", w.prior("bad.csv", [](Lines& l) { l.push_back(l[3]); })); },
       3,
       {"bad\\.csv, line [0-9]+, column name", "already given in line 4", "mend:"}},
      {"NegativeStd",
       [](const W& w) {
         return w.identify("", "", w.prior("bad.csv", [](Lines& l) {
           for (std::string& line : l) line += ",-1";
           l[0] = "name,value,unit,std";
         }));
       },
       3,
       {"bad\\.csv, line 2, column std", "negative", "mend:"}},
      {"LogAsPrior",
       [](const W& w) { return w.identify("", "", w.path("log.csv")); },
       3,
       {"log\\.csv", "column name is missing", "mend:"}},
      {"ForeignNames",
       [](const W& w) { return w.validate("", "", w.write("bad.csv", "name,value,unit\nmass,1,kg\n")); },
       3,
       {"bad\\.csv", "none of the robot's parameters is in the file", "mend:"}},
  };
}

std::vector<Row> robots() {
  return {
      {"NotXml",
       [](const W& w) { return w.identify("", w.path("prior.csv")); },
       3,
       {"prior\\.csv, line [0-9]+", "not well-formed XML", "mend:"}},
      {"NotUrdf",
       [](const W& w) { return w.info(w.write("bad.urdf", "<html><body/></html>\n")); },
       3,
       {"bad\\.urdf", "root element is <html>", "mend:"}},
      {"TornXml",
       [](const W& w) { return w.info(w.write("bad.urdf", to_text(W::robot()).substr(0, 5000))); },
       3,
       {"bad\\.urdf, line [0-9]+", "not well-formed XML", "mend:"}},
      {"SerialArm",
       [](const W& w) { return w.identify("", w.write("bad.urdf", kSerialArm)); },
       3,
       {"bad\\.urdf", "mend:"}},
      {"MissingLoop",
       [](const W& w) {
         return w.identify("", w.write("bad.urdf", without(W::robot(), "<loop name=\"strut2a_end\"", "</loop>")));
       },
       3,
       {"bad\\.urdf", "strut2a", "missing loop", "mend: add a spherical <loop>"}},
      {"MissingToolLoop",
       [](const W& w) {
         return w.info(w.write("bad.urdf", without(W::robot(), "<loop name=\"tool_axis\"", "</loop>")));
       },
       3,
       {"bad\\.urdf", "missing loop: the tool", "mend:"}},
      {"UnequalStruts",
       [](const W& w) {
         const std::string text = to_text(W::robot());
         const auto loop = text.find("<loop name=\"strut3b_end\"");
         const auto length = text.find("1.106", loop);
         return w.info(w.write("bad.urdf", text.substr(0, length) + "1.206" + text.substr(length + 5)));
       },
       3,
       {"bad\\.urdf", "unequal struts of limb 3", "1\\.206", "mend:"}},
      {"UnknownLink",
       [](const W& w) {
         return w.info(
             w.write("bad.urdf", replaced(to_text(W::robot()), "<child link=\"strut2b\"/>", "<child link=\"rod\"/>")));
       },
       3,
       {"bad\\.urdf, line [0-9]+", "unknown child link 'rod'", "mend:"}},
      {"TextInLength",
       [](const W& w) {
         return w.info(w.write("bad.urdf", replaced(to_text(W::robot()), "xyz=\"0.2 0 0\"", "xyz=\"0.2m 0 0\"")));
       },
       3,
       {"bad\\.urdf", "mend:"}},
      {"LimitsCrossed",
       [](const W& w) {
         return w.info(w.write("bad.urdf", replaced(to_text(W::robot()), "lower=\"-0.9\" upper=\"1.6\"",
                                                    "lower=\"1.6\" upper=\"-0.9\"")));
       },
       3,
       {"bad\\.urdf", "drive", "mend:"}},
      {"LengthsThatDoNotClose",
       [](const W& w) { return create_delta3(w.path("out.urdf"), 0.9, 0.05, 0.1, 0.3); },
       2,
       {"mend: check the lengths"}},
  };
}

/// delta-validate with an effect file of these rows.
Words with_effects(const W& w, const std::string& rows, const std::string& top = "") {
  return w.validate() + Words{"--effects", w.write("bad.csv", top + "effect,joint,parameter,value,unit,std\n" + rows)};
}

std::vector<Row> effects() {
  const std::string bend = "stribeck,drive2,rate,0.25,rad/s,\nstribeck,drive2,exponent,2,,\n";
  return {
      {"UnknownEffect",
       [](const W& w) { return with_effects(w, "gremlin,drive1,size,2,N,\n"); },
       3,
       {"bad\\.csv, line 2, column effect", "no effect 'gremlin'", "mend: .*--list-effects"}},
      {"EffectAtWrongPlace",
       [](const W& w) { return with_effects(w, "hose_force,drive2,force_x,2,N,\n"); },
       3,
       {"bad\\.csv, line 2, column joint", "cannot act at 'drive2'", "mend: give one of these: platform"}},
      {"EffectAtDriveThatIsNotThere",
       [](const W& w) { return with_effects(w, "torque_offset,drive5,offset,2,N*m,\n"); },
       3,
       {"bad\\.csv, line 2, column joint", "cannot act at 'drive5'",
        "mend: give one of these: drive1, drive2, drive3, drive4"}},
      {"EffectOfNoSuchKind",
       [](const W& w) {
         return with_effects(w, "kinematic_offset,drive1,error,0.001,SI,\nkinematic_offset,drive1,kind,7,,\n");
       },
       3,
       {"bad\\.csv, line 3, column value", "kind of kinematic_offset is 7, which is none of its values",
        "mend: give one of 0, 1, 2"}},
      {"EffectInPartOfALog",
       [](const W& w) { return with_effects(w, "payload,platform,mass,1,kg,\npayload,platform,log,1.4,,\n"); },
       3,
       {"bad\\.csv, line 3, column value", "log of payload is 1.4", "mend: give the number of the log"}},
      {"EffectKeyMissing",
       [=](const W& w) { return with_effects(w, bend); },
       3,
       {"bad\\.csv, line 2", "friction of stribeck at drive2 is missing",
        "mend: add a row stribeck,drive2,friction,VALUE,N\\*m,"}},
      {"EffectKeyUnknown",
       [=](const W& w) { return with_effects(w, bend + "stribeck,drive2,speed,2,N*m,\n"); },
       3,
       {"bad\\.csv, line 4, column parameter", "no parameter 'speed'",
        "mend: its parameters are friction, rate, exponent"}},
      {"EffectOfWrongSign",
       [=](const W& w) { return with_effects(w, bend + "stribeck,drive2,friction,-2,N*m,\n"); },
       3,
       {"bad\\.csv, line 4, column value", "friction of stribeck cannot be negative", "mend: give a positive number"}},
      {"EffectShapeNotPositive",
       [](const W& w) {
         return with_effects(
             w, "stribeck,drive2,friction,2,N*m,\nstribeck,drive2,rate,0,rad/s,\nstribeck,drive2,exponent,2,,\n");
       },
       3,
       {"bad\\.csv, line 3, column value", "rate of stribeck must be positive", "mend: give a number above 0"}},
      {"EffectBeyondItsRange",
       [](const W& w) { return with_effects(w, "saturation,drive2,level,20,N*m,\nsaturation,drive2,share,1.5,,\n"); },
       3,
       {"bad\\.csv, line 3, column value", "share of saturation is 1\\.5, beyond", "mend: give a number from -1 to 1"}},
      {"EffectNotFinite",
       [=](const W& w) { return with_effects(w, bend + "stribeck,drive2,friction,nan,N*m,\n"); },
       3,
       {"bad\\.csv, line 4, column value", "'nan' is not a finite number", "mend:"}},
      {"EffectInAnotherUnit",
       [=](const W& w) { return with_effects(w, bend + "stribeck,drive2,friction,2,N,\n"); },
       3,
       {"bad\\.csv, line 4, column unit", "unit 'N'", "mend: give the value in 'N\\*m'"}},
      {"TwoEffectsOfAKindAtOneJoint",
       [=](const W& w) {
         const std::string size = "stribeck,drive2,friction,2,N*m,\n";
         return with_effects(w, bend + size + size);
       },
       3,
       {"bad\\.csv, line 5, column parameter", "friction of stribeck at drive2 is there twice, first in line 4",
        "mend: leave one of the rows out"}},
      {"EffectFileOfOlderForm",
       [](const W& w) { return with_effects(w, "torque_offset,drive1,offset,2,N*m,\n", "# deltadyn effects 0\n"); },
       3,
       {"bad\\.csv, line 1", "is of version 0, this program reads version 1",
        "mend: run delta-diagnose again with --effects-out"}},
      {"EffectFileWithoutColumns",
       [](const W& w) {
         return w.validate() + Words{"--effects", w.path("prior.csv")};
       },
       3,
       {"prior\\.csv", "column 'effect' is missing", "mend: write the columns effect,joint,parameter,value,unit,std"}},
      {"EffectFileMissing",
       [](const W& w) {
         return w.validate() + Words{"--effects", w.path("none.csv")};
       },
       3,
       {"none\\.csv", "cannot open the file", "mend:"}},
      {"EffectWithoutRates",
       [](const W& w) { return with_effects(w, "torque_offset,drive1,offset,2,N*m,\n") + Words{"--no-filter"}; },
       3,
       {"log\\.csv", "column qd1_rad_s is missing", "mend:"}},
  };
}

class BadInput : public ::testing::TestWithParam<Row> {};

TEST_P(BadInput, IsRefusedWithAMessageAndLeavesNothingBehind) {
  expect_refused(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Files, BadInput, ::testing::ValuesIn(files()), name_of);
INSTANTIATE_TEST_SUITE_P(Times, BadInput, ::testing::ValuesIn(times()), name_of);
INSTANTIATE_TEST_SUITE_P(Motions, BadInput, ::testing::ValuesIn(motions()), name_of);
INSTANTIATE_TEST_SUITE_P(Priors, BadInput, ::testing::ValuesIn(priors()), name_of);
INSTANTIATE_TEST_SUITE_P(Effects, BadInput, ::testing::ValuesIn(effects()), name_of);
INSTANTIATE_TEST_SUITE_P(Robots, BadInput, ::testing::ValuesIn(robots()), name_of);

}  // namespace
}  // namespace deltadyn::acceptance
