// JSON text: escapes, numbers to the bit, nesting.
#include "adapters/json/json.hpp"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace silt::tests {
namespace {

using adapters::Json;

std::string one_line(const Json& j) {
  std::string s = j.text();
  EXPECT_EQ(s.back(), '\n');
  s.pop_back();
  return s;
}

TEST(Json, prints_nested_values_in_the_order_they_were_named) {
  Json j;
  j["steps"] = 3;
  j["name"] = "a";
  j["stages"]["collide"] = Json::object({{"min", 0.5}, {"max", 1.0}});
  j["skipped"].push_back("x");
  j["skipped"].push_back(nullptr == nullptr);
  j["steps"] = std::uint64_t{18446744073709551615u};
  j["rows"] = Json::array({Json::array_of(std::vector<int>{1, -2}), Json::object()});
  j["none"] = Json::array();
  EXPECT_EQ(
      j.text(),
      "{\n  \"steps\": 18446744073709551615,\n  \"name\": \"a\",\n  \"stages\": {\n    \"collide\": {\n"
      "      \"min\": 0.5,\n      \"max\": 1\n    }\n  },\n  \"skipped\": [\"x\", true],\n  \"rows\": [\n"
      "    [1, -2],\n    {}\n  ],\n  \"none\": []\n}\n");
}

TEST(Json, a_reference_to_a_member_lasts_while_others_are_added) {
  Json j;
  Json& first = j["0"];
  for (int k = 1; k < 100; ++k) j[std::to_string(k)] = k;
  EXPECT_EQ(&first, &j["0"]);
  j["a"] = j["b"] = j["c"] = 7;
  for (const char* name : {"a", "b", "c"}) EXPECT_EQ(one_line(j[name]), "7");
}

TEST(Json, escapes_what_must_be_and_repairs_broken_utf8) {
  EXPECT_EQ(one_line("\"a\\b\"\n\t\x01\x7f/"), "\"\\\"a\\\\b\\\"\\n\\t\\u0001\\u007f/\"");
  EXPECT_EQ(one_line("\u00e4\u2605\U0001f600"), "\"\u00e4\u2605\U0001f600\"");
  EXPECT_EQ(one_line("a\xff\xc3"), "\"a\ufffd\ufffd\"");
  EXPECT_EQ(one_line("\xed\xa0\x80"), "\"\ufffd\ufffd\ufffd\"");  // a surrogate
  EXPECT_EQ(one_line(std::string("\0", 1)), "\"\\u0000\"");
}

TEST(Json, numbers_read_back_to_the_same_bits) {
  for (const double x :
       {0.1, -0.0, 1e300, 5e-324, 1.0 / 3, 123456789.0, std::numeric_limits<double>::max()}) {
    const std::string s = one_line(x);
    double back = 0;
    std::from_chars(s.data(), s.data() + s.size(), back);
    EXPECT_EQ(back, x);
    EXPECT_EQ(std::signbit(back), std::signbit(x));
  }
  EXPECT_EQ(one_line(std::nan("")), "null");
  EXPECT_EQ(one_line(std::numeric_limits<double>::infinity()), "null");
  EXPECT_EQ(one_line(std::int64_t{std::numeric_limits<std::int64_t>::min()}), "-9223372036854775808");
}

TEST(Json, refuses_members_of_what_is_no_object) {
  Json j = 3;
  EXPECT_THROW(j["a"], std::logic_error);
  EXPECT_THROW(j.push_back(1), std::logic_error);
}

}  // namespace
}  // namespace silt::tests
