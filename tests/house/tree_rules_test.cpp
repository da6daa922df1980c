// The rules themselves, tried on made-up files: each must find its offender and leave the innocent alone.

#include "house/tree_rules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace deltadyn::house {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr const char* kCoreHeader = "include/deltadyn/kinematics/made_up.hpp";

SourceFile core_header(const std::string& body) {
  return {kCoreHeader, "#pragma once\n" + body};
}

TEST(FloorOf, IsTheFirstFolderBelowIncludeAndSrc) {
  EXPECT_EQ(floor_of("include/deltadyn/core/types.hpp"), "core");
  EXPECT_EQ(floor_of("src/io/urdf/reader.cpp"), "io");
  EXPECT_EQ(floor_of("include/deltadyn/deltadyn.hpp"), "");
  EXPECT_EQ(floor_of("tools/delta-model.cpp"), "");
}

TEST(WithoutComments, BlanksCommentsAndLiteralsAndKeepsLines) {
  EXPECT_EQ(without_comments("a // throw\nb", Literals::blank), "a         \nb");
  EXPECT_EQ(without_comments("a /* x\ny */ b", Literals::blank), "a     \n     b");
  EXPECT_EQ(without_comments("f(\"new // \\\" no\") + c", Literals::blank), "f(\"            \") + c");
  EXPECT_EQ(without_comments("f(\"new\")", Literals::keep), "f(\"new\")");
  EXPECT_EQ(without_comments("R\"(a \" b)\" + c", Literals::blank), "R\"       \" + c");
  EXPECT_EQ(without_comments("1'000 + 2'000 // x", Literals::blank), "1'000 + 2'000     ");
  EXPECT_EQ(without_comments("'\"' + new", Literals::blank), "' ' + new");
}

TEST(FloorIncludes, AFloorMayIncludeItselfAndLowerOnes) {
  EXPECT_THAT(
      check_floor_includes(core_header("#include \"deltadyn/kinematics/x.hpp\"\n#include \"deltadyn/core/y.hpp\"\n"
                                       "#include <Eigen/Core>\n// #include \"deltadyn/io/csv.hpp\"\n")),
      IsEmpty());
}

TEST(FloorIncludes, AHigherFloorIsFoundWithItsLine) {
  const auto findings =
      check_floor_includes(core_header("#include \"deltadyn/core/y.hpp\"\n  # include <deltadyn/dynamics/m.hpp>\n"));
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_EQ(findings[0].line, 3);
  EXPECT_THAT(findings[0].message, HasSubstr("'kinematics' must not include 'deltadyn/dynamics/m.hpp'"));
}

TEST(FloorIncludes, EveryFloorIsKeptFromAllAboveIt) {
  for (const std::string& lower : floors()) {
    for (const std::string& upper : floors()) {
      const bool allowed = floor_number(upper) <= floor_number(lower);
      EXPECT_EQ(check_floor_includes({"src/" + lower + "/a.cpp", "#include \"deltadyn/" + upper + "/b.hpp\""}).empty(),
                allowed)
          << lower << " includes " << upper;
    }
  }
}

TEST(FloorIncludes, UnknownFoldersUmbrellasAndDetoursAreFound) {
  EXPECT_THAT(check_floor_includes({"include/deltadyn/misc/a.hpp", ""}), SizeIs(1));
  EXPECT_THAT(check_floor_includes(core_header("#include \"deltadyn/misc/a.hpp\"")), SizeIs(1));
  EXPECT_THAT(check_floor_includes({"src/report/a.cpp", "#include \"deltadyn/deltadyn.hpp\""}), SizeIs(1));
  EXPECT_THAT(check_floor_includes(core_header("#include \"../io/csv.hpp\"")), SizeIs(1));
  EXPECT_THAT(check_floor_includes(core_header("#include \"../../deltadyn/io/csv.hpp\"")), SizeIs(1));
}

TEST(Core, BannedHeadersAreFoundOnEveryFloorDownToFirmwareOnly) {
  for (const std::string& floor : floors()) {
    const bool core = floor_number(floor) <= floor_number("firmware");
    for (const std::string header : {"iostream", "vector", "string", "map", "memory", "functional", "stdexcept",
                                     "sstream", "fstream", "exception", "new", "cstdlib"}) {
      EXPECT_THAT(check_core({"include/deltadyn/" + floor + "/a.hpp", "#include <" + header + ">"}),
                  SizeIs(core ? 1 : 0))
          << floor << " includes " << header;
    }
  }
}

TEST(Core, HeapExceptionsAndRunTimeTypesAreFound) {
  for (const std::string line :
       {"int* a = new int;", "delete a;", "delete[] a;", "throw 1;", "try { f(); }", "catch (...) {}",
        "auto b = dynamic_cast<B*>(a);", "typeid(a)", "void* p = malloc(3);", "std::free(p);", "Eigen::MatrixXd M;",
        "Eigen::VectorX<T> v;", "MatrixX3d M;", "Eigen::Matrix<T, Eigen::Dynamic, 1> v;", "std::vector<int> v;"}) {
    EXPECT_THAT(check_core(core_header(line + "\n")), ElementsAre(Field(&Finding::line, 2))) << line;
  }
}

TEST(Core, InnocentTextIsLeftAlone) {
  EXPECT_THAT(check_core(core_header(
                  "// throws nothing new, try it\n/* new throw */\nconst char* kText = \"throw new\";\n"
                  "int new_value = renew(trying);\nFoo(const Foo&) = delete;\nVector<T, 3> v;\nint free_joints;\n"
                  "#include <cmath>\n#include <type_traits>\n")),
              IsEmpty());
}

TEST(WrappedLibraries, EachHasOneHome) {
  EXPECT_THAT(check_wrapped_libraries({"src/identification/fit.cpp", "#include <ceres/ceres.h>"}), IsEmpty());
  EXPECT_THAT(check_wrapped_libraries({"src/excitation/search.cpp", "#include <nlopt.hpp>"}), IsEmpty());
  EXPECT_THAT(check_wrapped_libraries({"src/io/urdf.cpp", "#include <urdf_parser/urdf_parser.h>"}), IsEmpty());
  EXPECT_THAT(check_wrapped_libraries({"tests/model/a_test.cpp", "#include <ceres/jet.h>"}), IsEmpty());
  for (const std::string path :
       {"include/deltadyn/identification/fit.hpp", "src/report/html.cpp", "tools/delta-model.cpp"}) {
    EXPECT_THAT(check_wrapped_libraries(
                    {path, "#include <ceres/ceres.h>\n#include <nlopt.hpp>\n#include \"urdf_model/model.h\"\n"}),
                SizeIs(3))
        << path;
  }
}

TEST(Threads, LoopsOnSeveralThreadsHaveOneHome) {
  const std::string loop = "void f() {\n#pragma omp parallel for\n  for (;;) {}\n}\n";
  EXPECT_THAT(check_threads({"src/runtime/in_parallel.cpp", loop}), IsEmpty());
  EXPECT_THAT(check_threads({"tests/runtime/a_test.cpp", loop}), IsEmpty());
  EXPECT_THAT(check_threads({"src/io/a.cpp", "// #pragma omp parallel for\n"}), IsEmpty());
  EXPECT_THAT(check_threads({"src/io/a.cpp", loop}), ElementsAre(Field(&Finding::line, 2)));
  EXPECT_THAT(check_threads({"tools/a.cpp", loop}), SizeIs(1));
}

TEST(Shape, LongFilesAndUnguardedHeadersAreFound) {
  const auto lines = [](int n) {
    std::string text = "#pragma once\n";
    for (int i = 1; i < n; ++i) text += "//\n";
    return text;
  };
  EXPECT_THAT(check_shape({"include/deltadyn/io/a.hpp", lines(kMaxHeaderLines)}), IsEmpty());
  EXPECT_THAT(check_shape({"include/deltadyn/io/a.hpp", lines(kMaxHeaderLines + 1)}), SizeIs(1));
  EXPECT_THAT(check_shape({"src/io/a.cpp", lines(kMaxSourceLines)}), IsEmpty());
  EXPECT_THAT(check_shape({"src/io/a.cpp", lines(kMaxSourceLines + 1)}), SizeIs(1));
  EXPECT_THAT(check_shape({"include/deltadyn/io/a.hpp", "int x;\n"}), SizeIs(1));
  const std::string wide = std::string(static_cast<std::size_t>(kMaxColumns - 1), ' ') + "\u00B2";
  EXPECT_THAT(check_shape({"src/io/a.cpp", wide + "\n"}), IsEmpty());
  EXPECT_THAT(check_shape({"src/io/a.cpp", wide + " \n"}), SizeIs(1));
}

TEST(TopLevel, OnlyWhatTheDesignNamesHasAPlace) {
  EXPECT_THAT(check_top_level({"CMakeLists.txt", "include", "src", "tools", "tests", "data", "README.md",
                               "CMakePresets.json", "LICENSE", ".gitignore", ".ci", "build", "build-clang"}),
              IsEmpty());
  EXPECT_THAT(check_top_level({"src", "scripts", "notes.txt", "builder"}),
              ElementsAre(Field(&Finding::path, "scripts"), Field(&Finding::path, "notes.txt"),
                          Field(&Finding::path, "builder")));
}

}  // namespace
}  // namespace deltadyn::house
