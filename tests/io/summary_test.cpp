#include "deltadyn/io/summary.hpp"

#include <gtest/gtest.h>

#include "deltadyn/io/csv.hpp"

#include "io/temporary_folder.hpp"

namespace deltadyn {
namespace {

TEST(Summary, KeepsOrderAndReplacesValues) {
  const testing_support::TemporaryFolder folder;
  Summary summary;
  summary.add("base_parameters", 37);
  summary.add("rms_residual_drive1", 0.1 + 0.2, "N*m");
  summary.add("verdict", "named, and sure");
  summary.add("base_parameters", 34L);
  summary.write("");
  summary.write(folder.path("s.csv"));
  EXPECT_EQ(
      folder.read("s.csv"),
      "key,value,unit\nbase_parameters,34,\nrms_residual_drive1,0.30000000000000004,N*m\nverdict,named; and sure,\n");
  EXPECT_EQ(read_csv(folder.path("s.csv")).number(1, 1), 0.1 + 0.2);
}

}  // namespace
}  // namespace deltadyn
