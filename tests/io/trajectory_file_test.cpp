#include "deltadyn/io/trajectory_file.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <string>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/runtime/error.hpp"

#include "io/temporary_folder.hpp"
#include "support/descriptions.hpp"
#include "support/matchers.hpp"

namespace deltadyn {
namespace {

using ::deltadyn::testing_support::TemporaryFolder;
using ::testing::HasSubstr;
using testing_support::delta_description;
using testing_support::IsNear;

/// A smooth motion inside the workspace with exact derivatives.
TrajectorySamples motion(const Robot& robot, Eigen::Index n = 400) {
  TrajectorySamples s;
  const int m = robot.drives();
  s.t_s = Eigen::VectorXd::LinSpaced(n, 0, 0.001 * static_cast<double>(n - 1));
  s.z = s.zd = s.zdd = Eigen::MatrixXd::Zero(n, m);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (int k = 0; k < m; ++k) {
      const double w = 5.0 + k, size = k < 3 ? 0.1 : 2.0;
      s.z(i, k) = (k == 2 ? -0.85 : 0.0) + size * std::sin(w * s.t_s(i));
      s.zd(i, k) = size * w * std::cos(w * s.t_s(i));
      s.zdd(i, k) = -size * w * w * std::sin(w * s.t_s(i));
    }
  }
  complete_drives(robot, s);
  return s;
}

/// The file again with the columns only whose names pass.
template <class Keep>
std::string with_columns(const std::string& path, Keep keep) {
  const CsvTable table = read_csv(path);
  std::string text;
  for (const auto& name : table.columns()) text += keep(name) ? (text.empty() ? "" : ",") + name : "";
  text += "\n";
  for (std::size_t row = 0; row < table.rows(); ++row) {
    std::string line;
    for (std::size_t c = 0; c < table.columns().size(); ++c) {
      if (keep(table.columns()[c])) line += (line.empty() ? "" : ",") + std::string(table.text(row, c));
    }
    text += line + "\n";
  }
  return text;
}

TEST(TrajectoryFile, ReadsBackExactlyWhatItWrote) {
  const TemporaryFolder folder;
  const auto robot = make_robot(delta_description("delta4"));
  const TrajectorySamples written = motion(*robot);
  write_trajectory(folder.path("t.csv"), written, robot->description(), "made by a test");
  const TrajectorySamples read = read_trajectory(folder.path("t.csv"), *robot);
  EXPECT_THAT(folder.read("t.csv"),
              HasSubstr("t_s,x_m,y_m,z_m,psi_rad,xd_m_s,yd_m_s,zd_m_s,psid_rad_s,xdd_m_s2,ydd_m_s2,"
                        "zdd_m_s2,psidd_rad_s2,q1_rad,q2_rad"));
  for (const auto& [a, b] : {std::pair{read.z, written.z},
                             {read.zd, written.zd},
                             {read.zdd, written.zdd},
                             {read.q, written.q},
                             {read.qd, written.qd},
                             {read.qdd, written.qdd}}) {
    EXPECT_THAT(a, IsNear(b, 0.0));
  }
}

TEST(TrajectoryFile, ComputesWhatIsMissing) {
  const TemporaryFolder folder;
  const auto robot = make_robot(delta_description("delta4"));
  const TrajectorySamples written = motion(*robot);
  write_trajectory(folder.path("t.csv"), written, robot->description());
  const auto is_drive = [](const std::string& name) { return name[0] == 'q' || name == "t_s"; };
  const auto is_task = [](const std::string& name) { return name[0] != 'q'; };
  const auto is_position = [](const std::string& name) {
    return name == "x_m" || name == "y_m" || name == "z_m" || name == "psi_rad" || name == "t_s";
  };
  for (const std::string& text :
       {with_columns(folder.path("t.csv"), is_drive), with_columns(folder.path("t.csv"), is_task)}) {
    const TrajectorySamples read = read_trajectory(folder.write("part.csv", text), *robot);
    EXPECT_THAT(read.zdd, IsNear(written.zdd, 1e-8));
    EXPECT_THAT(read.qdd, IsNear(written.qdd, 1e-8));
    EXPECT_THAT(read.q, IsNear(written.q, 1e-10));
  }
  const TrajectorySamples read =
      read_trajectory(folder.write("z.csv", with_columns(folder.path("t.csv"), is_position)), *robot);
  EXPECT_THAT(read.zd, IsNear(written.zd, 1e-8));
  EXPECT_THAT(read.zdd, IsNear(written.zdd, 2e-5));
}

TEST(TrajectoryFile, AnAxisAndLinearDrivesHaveTheirOwnColumns) {
  const TemporaryFolder folder;
  const auto axis = make_robot(testing_support::axis_description(DriveKind::prismatic));
  const TrajectorySamples written = motion(*axis);
  write_trajectory(folder.path("a.csv"), written, axis->description());
  EXPECT_THAT(folder.read("a.csv"), HasSubstr("t_s,q1_m,qd1_m_s,qdd1_m_s2\n"));
  EXPECT_THAT(read_trajectory(folder.path("a.csv"), *axis).zdd, IsNear(written.zdd, 0.0));
}

TEST(TrajectoryFile, PoseAndDrivesMustTellOneMotion) {
  const TemporaryFolder folder;
  const auto robot = make_robot(delta_description("delta4"));
  const TrajectorySamples good = motion(*robot);
  const auto refusal = [&](const TrajectorySamples& samples) {
    write_trajectory(folder.path("t.csv"), samples, robot->description());
    try {
      (void)read_trajectory(folder.path("t.csv"), *robot);
      return std::string("accepted");
    } catch (const Error& error) {
      return error.where() + ": " + error.problem();
    }
  };
  EXPECT_EQ(refusal(good), "accepted");
  TrajectorySamples bad = good;
  bad.q(5, 1) += 0.05;  // of a robot file whose lengths are a little off
  EXPECT_EQ(refusal(bad), "accepted");
  bad.q(5, 1) += 0.1;
  EXPECT_THAT(refusal(bad), ::testing::AllOf(HasSubstr("line 7, column q2_rad"), HasSubstr("needs")));
  bad = good;
  bad.q.col(3) *= 57.3;  // degrees under the name of radians
  EXPECT_THAT(refusal(bad), HasSubstr("q4_rad"));
  bad = good;
  bad.z.leftCols(3) *= 1000;
  EXPECT_THAT(refusal(bad), HasSubstr("x_m"));
}

TEST(TrajectoryFile, RefusesWithFileLineAndColumn) {
  const TemporaryFolder folder;
  const auto robot = make_robot(delta_description("delta3"));
  const auto message_of = [&](const std::string& text) -> std::string {
    try {
      (void)read_trajectory(folder.write("bad.csv", text), *robot);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(message_of("t_s,x_m\n0,0\n"), HasSubstr("x_m, y_m, z_m"));
  EXPECT_THAT(message_of("t_s,x_m,y_m,z_m\n0,0,0,-0.8\n0.001,0,0,-0.8\n"), HasSubstr("2 rows are too few"));
  EXPECT_THAT(message_of("t_s,x_m,y_m,z_m\n0,0,0,-0.8\n0,0,0,-0.8\n"), HasSubstr("line 3, column t_s"));
  EXPECT_THAT(message_of("t_s,x_m,y_m,z_m\n0,0,0,-0.8\n0.001,0,abc,-0.8\n"), HasSubstr("line 3, column y_m"));
  const std::string header = "t_s,x_m,y_m,z_m,xd_m_s,yd_m_s,zd_m_s,xdd_m_s2,ydd_m_s2,zdd_m_s2\n";
  EXPECT_THAT(message_of(header + "0.5,0,0,-5,0,0,0,0,0,0\n"), HasSubstr("t = 0.5 s the pose is out of reach"));
  EXPECT_THAT(message_of("t_s,q1_rad,q2_rad,q3_rad,qd1_rad_s,qd2_rad_s,qd3_rad_s,qdd1_rad_s2,qdd2_rad_s2,qdd3_rad_s2\n"
                         "0,0,0,,0,0,0,0,0,0\n"),
              HasSubstr("line 2, column q3_rad"));
}

}  // namespace
}  // namespace deltadyn
