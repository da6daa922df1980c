#include "deltadyn/report/plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <set>

#include "deltadyn/runtime/error.hpp"

#include "report/xml_checks.hpp"

namespace deltadyn {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using testing_support::attributes;
using testing_support::texts;

const double kMissing = std::numeric_limits<double>::quiet_NaN();

Series sine(const std::string& label, Eigen::Index n = 200) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(n, 0.0, 10.0);
  return {label, x, x.array().sin()};
}

PlotSpec simple() {
  PlotSpec spec;
  spec.title = "Drive 1";
  spec.x_label = "time [s]";
  spec.y_label = "torque [N m]";
  spec.series = {sine("measured")};
  return spec;
}

/// Sets an environment variable until the end of the test.
class EnvironmentGuard {
 public:
  EnvironmentGuard(const char* name, const std::string& value)
      : name_(name), old_(std::getenv(name) ? std::getenv(name) : "") {
    ::setenv(name, value.c_str(), 1);
  }
  EnvironmentGuard(const EnvironmentGuard&) = delete;
  EnvironmentGuard& operator=(const EnvironmentGuard&) = delete;
  ~EnvironmentGuard() { ::setenv(name_, old_.c_str(), 1); }

 private:
  const char* name_;
  std::string old_;
};

class EmptyFolder {
 public:
  EmptyFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "deltadyn-plot-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  EmptyFolder(const EmptyFolder&) = delete;
  EmptyFolder& operator=(const EmptyFolder&) = delete;
  ~EmptyFolder() { std::filesystem::remove_all(path_); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) names.push_back(entry.path().filename());
    return names;
  }

 private:
  std::filesystem::path path_;
};

TEST(RenderSvg, ShowsTitleAxesWithUnitsAndLegend) {
  const auto found = texts(render_svg({simple()}), "text");
  EXPECT_THAT(found, Contains("Drive 1"));
  EXPECT_THAT(found, Contains("time [s]"));
  EXPECT_THAT(found, Contains("torque [N m]"));
  EXPECT_THAT(found, Contains("measured"));
}

TEST(RenderSvg, HostileTextIsDrawnAsItIsAndNeverRun) {
  const EmptyFolder folder;
  const std::string target = (folder.path() / "made").string();
  const std::vector<std::string> hostile{"`touch " + target + "`",
                                         "'; system(\"touch " + target + "\") #",
                                         "\"; !touch " + target,
                                         "'''' 'x' ''",
                                         "\\",
                                         "\"",
                                         "x\\",
                                         "''x",
                                         "100 %",
                                         "%h 5%",
                                         "-4-07'1",
                                         "$HOME @x #5",
                                         "a_b^{c} @x {/Bold y} \\n %s",
                                         "<script>alert('&amp;')</script> & co",
                                         "it's \"quoted\" \xC2\xB5\xC3\xA9"};
  for (const std::string& text : hostile) {
    PlotSpec spec = simple();
    spec.title = spec.x_label = spec.y_label = spec.series[0].label = text;
    spec.horizontal_markers = {{0.5, text}};
    spec.vertical_markers = {{5.0, text}};
    EXPECT_EQ(std::ranges::count(texts(render_svg({spec}), "text"), text), 6) << text;
    spec.x_tick_labels = {text};
    EXPECT_EQ(std::ranges::count(texts(render_svg({spec}), "text"), text), 7) << text;
  }
  EXPECT_TRUE(folder.files().empty());
}

TEST(RenderSvg, LineBreaksInTextCannotStartACommand) {
  PlotSpec spec = simple();
  spec.title = "one\nexit\ntwo";
  EXPECT_THAT(texts(render_svg({spec}), "text"), Contains("one exit two"));
}

TEST(RenderSvg, IdsAreUniqueCarryThePrefixAndEveryReferenceHasItsTarget) {
  PlotSpec spec = simple();
  spec.series.push_back(sine("samples", 20));
  spec.series.back().style = SeriesStyle::points;
  const std::string svg = render_svg({spec}, "fig7-");
  const auto ids = attributes(svg, "id");
  ASSERT_FALSE(ids.empty());
  EXPECT_EQ(std::set<std::string>(ids.begin(), ids.end()).size(), ids.size());
  for (const std::string& id : ids) EXPECT_TRUE(id.starts_with("fig7-")) << id;
  const auto links = attributes(svg, "xlink:href");
  ASSERT_FALSE(links.empty());
  for (const std::string& link : links) EXPECT_THAT(ids, Contains(link.substr(1)));
}

TEST(RenderSvg, ScalesWithThePageAndSaysWhatItShows) {
  const std::string svg = render_svg({simple()});
  EXPECT_TRUE(svg.starts_with("<svg"));
  testing_support::for_each_element(svg, [](const tinyxml2::XMLElement& element) {
    if (std::string(element.Name()) != "svg") return;
    EXPECT_STREQ(element.Attribute("width"), "100%");
    EXPECT_EQ(element.Attribute("height"), nullptr);
    EXPECT_STREQ(element.Attribute("viewBox"), "0 0 900 320");
    EXPECT_STREQ(element.Attribute("aria-label"), "Drive 1");
  });
}

TEST(RenderSvg, SameInputGivesTheSameBytes) {
  EXPECT_EQ(render_svg({simple()}), render_svg({simple()}));
}

TEST(RenderSvg, ALongSeriesStaysSmall) {
  PlotSpec spec = simple();
  spec.series = {sine("measured", 1'000'000), sine("model", 1'000'000), sine("points", 1'000'000)};
  spec.series[2].style = SeriesStyle::points;
  spec.series[2].y = Eigen::VectorXd::Random(1'000'000);
  EXPECT_LT(render_svg({spec}).size(), 300'000u);
}

TEST(RenderSvg, DrawsEveryStyle) {
  for (const SeriesStyle style :
       {SeriesStyle::line, SeriesStyle::points, SeriesStyle::impulses, SeriesStyle::steps, SeriesStyle::errorbars}) {
    PlotSpec empty = simple();
    empty.series[0].y.setConstant(kMissing);
    PlotSpec spec = simple();
    spec.series[0] = sine("s", 30);
    spec.series[0].style = empty.series[0].style = style;
    if (style == SeriesStyle::errorbars) {
      spec.series[0].y_error = Eigen::VectorXd::Constant(30, 0.2);
      empty.series[0].y_error = Eigen::VectorXd::Constant(200, 0.2);
    }
    EXPECT_THAT(render_svg({spec}), HasSubstr("plot-gnuplot_plot_1"));
    EXPECT_THAT(texts(render_svg({empty}), "text"), Contains("no data"));
  }
}

TEST(RenderSvg, OddDataIsDrawnWithoutComplaint) {
  const auto with_y = [](std::initializer_list<double> y) {
    PlotSpec spec = simple();
    spec.series[0].x = Eigen::VectorXd::LinSpaced(static_cast<Eigen::Index>(y.size()), 0.0, 1.0);
    spec.series[0].y.resize(static_cast<Eigen::Index>(y.size()));
    std::copy(y.begin(), y.end(), spec.series[0].y.begin());
    return spec;
  };
  const double inf = std::numeric_limits<double>::infinity();
  for (const PlotSpec& spec : {with_y({1.0, 1.0}), with_y({0.0, 0.0, 0.0}), with_y({5.0}), with_y({1e-320, 0.0}),
                               with_y({kMissing, 2.0, inf}), with_y({-1e299, 1e299}), with_y({1e9, 1e9 + 1e-6})}) {
    for (const bool log : {false, true}) {
      PlotSpec variant = spec;
      variant.log_y = log;
      EXPECT_NO_THROW(static_cast<void>(render_svg({variant})));
    }
  }
  PlotSpec none = simple();
  none.series.clear();
  EXPECT_THAT(texts(render_svg({none}), "text"), Contains("no data"));
}

TEST(RenderSvg, LogAxesLeaveOutWhatIsNotPositive) {
  PlotSpec spec = simple();
  spec.log_x = spec.log_y = true;
  spec.series[0].x = Eigen::Vector4d(-1.0, 0.0, 1.0, 1e6);
  spec.series[0].y = Eigen::Vector4d(1.0, 1.0, 1e-9, 1e-2);
  const auto found = texts(render_svg({spec}), "text");
  EXPECT_THAT(found, Contains("10-8"));  // the exponent stands higher, as a part of the same text
  EXPECT_THAT(found, Contains("105"));
}

TEST(RenderSvg, MarkersOutsideTheRangeAreLeftOut) {
  PlotSpec spec = simple();
  spec.y_range = PlotRange{-2.0, 2.0};
  spec.horizontal_markers = {{1.5, "inside"}, {3.0, "outside"}};
  const auto found = texts(render_svg({spec}), "text");
  EXPECT_THAT(found, Contains("inside"));
  EXPECT_THAT(found, Not(Contains("outside")));
}

TEST(RenderSvg, PanelsShareTheTimeAxisAndOneLegend) {
  PlotSpec upper = simple(), lower = simple();
  lower.title = "Drive 2";
  const auto found = texts(render_svg({upper, lower}), "text");
  EXPECT_THAT(found, Contains("Drive 1"));
  EXPECT_THAT(found, Contains("Drive 2"));
  EXPECT_EQ(std::ranges::count(found, "time [s]"), 1);
  EXPECT_EQ(std::ranges::count(found, "torque [N m]"), 2);
  EXPECT_EQ(std::ranges::count(found, "measured"), 1);
  lower.series[0].label = "model";
  EXPECT_THAT(texts(render_svg({upper, lower}), "text"), Contains("model"));
}

TEST(RenderSvg, PanelsWithAnotherAxisHaveTheirOwn) {
  PlotSpec upper = simple(), lower = simple();
  lower.x_label = "angle [rad]";
  for (Series& series : lower.series) series.x = 1e3 * series.x;
  const auto found = texts(render_svg({upper, lower}), "text");
  EXPECT_EQ(std::ranges::count(found, "time [s]"), 1);
  EXPECT_EQ(std::ranges::count(found, "angle [rad]"), 1);
  const auto alone = texts(render_svg({upper}), "text");
  for (const std::string& text : alone) EXPECT_THAT(found, Contains(text)) << "numbers of its axis";
}

TEST(RenderSvg, ContradictionsAreRefused) {
  const auto refused = [](const PlotSpec& spec) {
    try {
      static_cast<void>(render_svg({spec}));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::usage);
      EXPECT_THAT(error.where(), HasSubstr("Drive 1"));
      return error.problem();
    }
    return std::string("accepted");
  };
  PlotSpec spec = simple();
  spec.series[0].y.resize(3);
  EXPECT_EQ(refused(spec), "series \"measured\" has 200 x values and 3 y values");
  spec = simple();
  spec.series[0].style = SeriesStyle::errorbars;
  EXPECT_EQ(refused(spec), "series \"measured\" has 200 y values and 0 bars");
  spec = simple();
  spec.y_range = PlotRange{1.0, 1.0};
  EXPECT_THAT(refused(spec), HasSubstr("y range"));
  spec = simple();
  spec.log_x = true;
  spec.x_range = PlotRange{0.0, 1.0};
  EXPECT_THAT(refused(spec), HasSubstr("positive"));
  spec = simple();
  spec.height = 60;
  EXPECT_THAT(refused(spec), HasSubstr("no room"));
  PlotSpec logarithmic = simple();
  logarithmic.log_x = true;
  EXPECT_THROW(static_cast<void>(render_svg({simple(), logarithmic})), Error);
  EXPECT_THROW(static_cast<void>(render_svg(std::vector<PlotSpec>{})), Error);
}

TEST(RenderSvg, WithoutGnuplotSaysWhatToInstall) {
  const EmptyFolder folder;
  const EnvironmentGuard path("PATH", folder.path().string());
  EXPECT_FALSE(gnuplot_available());
  try {
    static_cast<void>(render_svg({simple()}));
    FAIL() << "drawn without gnuplot";
  } catch (const Error& error) {
    EXPECT_THAT(error.problem(), HasSubstr("gnuplot cannot be started"));
    EXPECT_THAT(error.mend(), HasSubstr("install gnuplot-nox"));
    EXPECT_EQ(error.code(), ExitCode::bad_input);
  }
  EXPECT_THROW(render_png({simple()}, folder.path() / "plot.png"), Error);
  EXPECT_TRUE(folder.files().empty());
}

TEST(RenderSvg, AGnuplotThatFailsIsReportedWithItsOwnWords) {
  const EmptyFolder folder;
  std::ofstream(folder.path() / "gnuplot") << "#!/bin/sh\necho 'no such terminal' >&2\nexit 3\n";
  std::filesystem::permissions(folder.path() / "gnuplot", std::filesystem::perms::owner_all);
  const EnvironmentGuard path("PATH", folder.path().string());
  PlotSpec spec = simple();  // much more input than a channel holds, which the child never reads
  for (int i = 0; i < 40; ++i) spec.series.push_back(sine("s", 2'000));
  try {
    static_cast<void>(render_svg({spec}));
    FAIL() << "a failed gnuplot went unnoticed";
  } catch (const Error& error) {
    EXPECT_THAT(error.problem(), HasSubstr("exit code 3"));
    EXPECT_THAT(error.problem(), HasSubstr("no such terminal"));
  }
}

TEST(RenderPng, WritesAPictureOfTwiceTheSizeAndLeavesNothingElse) {
  const EmptyFolder folder;
  render_png({simple()}, folder.path() / "plot.png");
  EXPECT_THAT(folder.files(), ElementsAre("plot.png"));
  std::ifstream file(folder.path() / "plot.png", std::ios::binary);
  std::string head(24, '\0');
  file.read(head.data(), 24);
  EXPECT_EQ(head.substr(0, 8), "\x89PNG\r\n\x1a\n");
  const auto size_at = [&](std::size_t i) {
    return 256 * static_cast<unsigned char>(head[i + 2]) + static_cast<unsigned char>(head[i + 3]);
  };
  EXPECT_EQ(size_at(16), 1800);
  EXPECT_EQ(size_at(20), 640);
}

TEST(RenderPng, AFolderThatDoesNotExistIsAnError) {
  const EmptyFolder folder;
  EXPECT_THROW(render_png({simple()}, folder.path() / "missing" / "plot.png"), Error);
}

}  // namespace
}  // namespace deltadyn
