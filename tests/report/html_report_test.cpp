#include "deltadyn/report/html_report.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
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

PlotSpec plot() {
  PlotSpec spec;
  spec.title = "Drive 1";
  spec.x_label = "time [s]";
  spec.y_label = "torque [N m]";
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(100, 0.0, 1.0);
  spec.series = {{"measured", x, x.array().square(), SeriesStyle::points}};
  return spec;
}

HtmlReport full_report(const std::string& text) {
  HtmlReport report(text, text);
  report.verdict(Verdict::caution, text, {text})
      .key_figures({{text, text, text, Tone::good}})
      .heading(text)
      .subheading(text)
      .paragraph(text)
      .note(text)
      .list({text})
      .table(Table({{text, Align::left}}).row({text}, Tone::bad), text)
      .facts({{text, text}})
      .plot(plot(), text)
      .details(text, [&](HtmlReport& inside) { inside.paragraph(text); })
      .heading(text)
      .heading(text)
      .footer(text);
  return report;
}

TEST(HtmlReport, IsWellFormedWhateverTheText) {
  for (const std::string text :
       {"plain", "<script>alert(1)</script>", "a & b &amp; \"c\" 'd'", "]]> --> <!--", "\x01\xff\xc3(", "</style>"}) {
    const std::string page = full_report(text).str();
    EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
    EXPECT_THAT(texts(page, "h1"), ::testing::SizeIs(1)) << text;
    EXPECT_TRUE(texts(page, "script").empty());
  }
}

TEST(HtmlReport, ReadersSeeTheTextAsItWasGiven) {
  const std::string text = "drive<1> & \"co\" it's µ";
  const std::string page = full_report(text).str();
  for (const char* name : {"title", "h1", "h2", "h3", "li", "td", "th", "dt", "dd", "summary", "p"})
    EXPECT_THAT(texts(page, name), Contains(text)) << name;
  EXPECT_THAT(texts(page, "caption"), ElementsAre("Table 1. " + text));
  EXPECT_THAT(texts(page, "figcaption"), ElementsAre("Figure 1. " + text));
  EXPECT_THAT(texts(page, "footer")[0], HasSubstr(text));
}

TEST(HtmlReport, NeedsNothingFromOutside) {
  const std::string page = full_report("x").str();
  for (const char* attribute : {"src", "href", "xlink:href", "action"})
    for (const std::string& target : attributes(page, attribute)) EXPECT_TRUE(target.starts_with("#")) << target;
  EXPECT_THAT(page, Not(HasSubstr("@import")));
  EXPECT_THAT(page, Not(HasSubstr("url(http")));
  EXPECT_TRUE(texts(page, "link").empty());
}

TEST(HtmlReport, IdsOfSeveralPlotsDoNotClash) {
  HtmlReport report("two plots");
  report.plot(plot()).plot(plot()).plot({plot(), plot()}).heading("a").heading("b").heading("c");
  const std::string page = report.str();
  const auto ids = attributes(page, "id");
  const std::set<std::string> unique(ids.begin(), ids.end());
  EXPECT_GT(ids.size(), 30u);
  EXPECT_EQ(unique.size(), ids.size());
  for (const char* attribute : {"href", "xlink:href"})
    for (const std::string& target : attributes(page, attribute))
      EXPECT_TRUE(unique.contains(target.substr(1))) << target;
}

TEST(HtmlReport, VerdictIsSaidByClassAndBySign) {
  const auto page = [](Verdict verdict) { return HtmlReport("r").verdict(verdict, "headline", {"line"}).str(); };
  EXPECT_THAT(attributes(page(Verdict::good), "class"), Contains("verdict good"));
  EXPECT_THAT(attributes(page(Verdict::caution), "class"), Contains("verdict caution"));
  EXPECT_THAT(attributes(page(Verdict::bad), "class"), Contains("verdict bad"));
  std::set<std::string> signs;
  for (const Verdict verdict : {Verdict::good, Verdict::caution, Verdict::bad})
    signs.insert(texts(page(verdict), "span")[0]);
  EXPECT_EQ(signs.size(), 3u);
}

TEST(HtmlReport, TablesKeepOrderAlignmentAndHighlight) {
  Table table({{"name", Align::left}, {"value [kg]"}});
  table.row({"m", "1.2 ± 0.1"}).row({"mcx", "–"}, Tone::caution);
  const std::string page = HtmlReport("r").table(table).table(table, "second").str();
  EXPECT_THAT(texts(page, "td"), ElementsAre("m", "1.2 ± 0.1", "mcx", "–", "m", "1.2 ± 0.1", "mcx", "–"));
  EXPECT_THAT(texts(page, "caption"), ElementsAre("Table 1. second"));
  std::vector<std::string> row_classes, cell_classes;
  testing_support::for_each_element(page, [&](const tinyxml2::XMLElement& element) {
    const char* value = element.Attribute("class");
    if (std::string(element.Name()) == "tr") row_classes.emplace_back(value == nullptr ? "" : value);
    if (std::string(element.Name()) == "td") cell_classes.emplace_back(value == nullptr ? "" : value);
  });
  EXPECT_THAT(row_classes, ElementsAre("", "", "caution", "", "", "caution"));
  EXPECT_EQ(cell_classes[0], "left");
  EXPECT_EQ(cell_classes[1], "right");
}

TEST(HtmlReport, ARowOfTheWrongLengthIsRefused) {
  Table table({{"a"}, {"b"}});
  EXPECT_THROW(table.row({"1"}), Error);
  EXPECT_THROW(table.row({"1", "2", "3"}), Error);
  EXPECT_TRUE(table.empty());
}

TEST(HtmlReport, AnEmptyTableSaysSo) {
  EXPECT_THAT(texts(HtmlReport("r").table(Table({{"a"}, {"b"}})).str(), "td"), ElementsAre("none"));
}

TEST(HtmlReport, ContentsAppearFromThreeSectionsOn) {
  HtmlReport report("r");
  report.heading("one").heading("two");
  EXPECT_TRUE(texts(report.str(), "nav").empty());
  report.heading("three");
  EXPECT_THAT(texts(report.str(), "a"), ElementsAre("one", "two", "three"));
}

TEST(HtmlReport, DetailsHoldTheirParts) {
  const std::string page = HtmlReport("r")
                               .details("more", [](HtmlReport& inside) { inside.paragraph("inside"); })
                               .paragraph("outside")
                               .str();
  ASSERT_EQ(texts(page, "details").size(), 1u);
  EXPECT_THAT(texts(page, "details")[0], HasSubstr("inside"));
  EXPECT_THAT(texts(page, "details")[0], Not(HasSubstr("outside")));
}

TEST(HtmlReport, DetailsAreClosedAlsoWhenTheirContentFails) {
  HtmlReport report("r");
  EXPECT_THROW(report.details("more", [](HtmlReport&) { throw Error("no data", "", ""); }), Error);
  report.paragraph("after");
  EXPECT_THAT(texts(report.str(), "p"), Contains("after"));
  EXPECT_THAT(texts(report.str(), "details")[0], Not(HasSubstr("after")));
}

TEST(HtmlReport, SameCallsGiveTheSameBytes) {
  EXPECT_EQ(full_report("x").str(), full_report("x").str());
}

TEST(HtmlReport, ALargeReportStaysUnderTwoMegabytes) {
  HtmlReport report("large");
  PlotSpec panel = plot();
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(500'000, 0.0, 500.0);
  panel.series = {{"measured", t, Eigen::VectorXd::Random(t.size())},
                  {"model", t, Eigen::VectorXd::Random(t.size())},
                  {"residual", t, Eigen::VectorXd::Random(t.size())}};
  panel.height = 220;
  for (int i = 0; i < 3; ++i) report.plot({panel, panel, panel, panel});
  EXPECT_LT(report.str().size(), 2'000'000u);
}

TEST(EscapeHtml, KeepsLettersAndReplacesWhatXmlForbids) {
  EXPECT_EQ(escape_html("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
  EXPECT_EQ(escape_html("µ ± ² 漢 😀\n\t"), "µ ± ² 漢 😀\n\t");
  EXPECT_EQ(escape_html(std::string_view("a\0b\x1b"
                                         "c\x7f",
                                         6)),
            "a?b?c?");
  EXPECT_EQ(escape_html("\xff"), "?");
  EXPECT_EQ(escape_html("\xc3"), "?");                 // cut off
  EXPECT_EQ(escape_html("\xc0\xaf"), "??");            // overlong
  EXPECT_EQ(escape_html("\xed\xa0\x80"), "???");       // surrogate
  EXPECT_EQ(escape_html("\xf5\x80\x80\x80"), "????");  // beyond Unicode
}

}  // namespace
}  // namespace deltadyn
