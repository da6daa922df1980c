#include "deltadyn/core/status.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>
#include <string>

namespace deltadyn {
namespace {

TEST(StatusMessage, TellsEveryStatusApart) {
  std::set<std::string> messages;
  for (const Status s : {Status::ok, Status::unreachable, Status::singular, Status::ambiguous, Status::out_of_range}) {
    messages.insert(message(s));
  }
  EXPECT_EQ(messages.size(), 5U);
  EXPECT_EQ(messages.count("unknown status"), 0U);
}

TEST(StatusMessage, IsPlain) {
  EXPECT_THAT(message(Status::unreachable), ::testing::HasSubstr("out of reach"));
}

}  // namespace
}  // namespace deltadyn
