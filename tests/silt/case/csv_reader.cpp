// CSV files as other programs write them: what they say is read, or refused by a message that names what is
// unusual in them. Nothing vanishes.
#include "silt/case/csv_reader.hpp"

#include <gtest/gtest.h>

#include <array>
#include <sstream>

#include "silt/case/case_sections.hpp"
#include "tests/errors.hpp"

namespace silt::testing {
namespace {

using Rows = std::vector<std::array<double, 3>>;

struct Contents {
  int headings = 0;
  Rows rows;
  std::string fault;  // with its line
};

Contents contents_of(const std::string& text) {
  std::istringstream stream(text);
  CsvReader reader(stream);
  Contents found{static_cast<int>(reader.headings().size()), {}, ""};
  while (reader.next()) try {
      reader.numbers(found.rows.emplace_back(), "three numbers");
    } catch (const std::invalid_argument& error) {
      found.rows.pop_back();
      found.fault = "line " + std::to_string(reader.lines()) + " " + error.what();
      break;
    }
  return found;
}

const Rows both = {{4, -5.5, 600}, {14.5, 15.25, 16}};
const std::string second = "14.5,15.25,16\n";

TEST(CsvReader, ReadsWhatIsClear) {
  struct Dialect {
    const char* name;
    std::string text;
    int headings = 0;
  };
  const std::string first = "4,-5.5,6e2";
  const Dialect dialects[] = {
      {"plain", first + "\n" + second},
      {"CR", first + "\r14.5,15.25,16\r"},
      {"byte order mark, headings, CRLF", "\xEF\xBB\xBFx,y,z\r\n" + first + "\r\n" + second, 1},
      {"plus signs", "+4,-5.5,+6E+2\n" + second},
      {"quotes", "\"4\",\"-5.5\",\"+600\"\n\"14.5\", \"15.25\" ,\"16\"\n"},
      {"blanks in quotes", "\" 4 \",-5.5,600\n" + second},
      {"blanks and tabs around numbers", "  4 ,\t-5.5 , 600  \n" + second},
      {"bare points", "4.,-5.5,.6e3\n" + second},
      {"headings of ParaView", "\"Points:0\",\"Points:1\",\"Points:2\"\n" + first + "\n" + second, 1},
      {"headings with a comma in quotes", "\"x, in m\",\"y\"\"\",z\n" + first + "\n" + second, 1},
      {"headings of several lines", "cloud of the mill\nx,y,z\n[mm],[mm],[mm]\n" + first + "\n" + second, 3},
      {"comments and blank lines", "# 3 points\n\nx,y,z\n  # 1,2,3\n" + first + "\n \t\n" + second, 1},
      {"sep= of spreadsheets", "sep=,\n" + first + "\n" + second, 1},
  };
  for (const Dialect& dialect : dialects) {
    const Contents found = contents_of(dialect.text);
    EXPECT_EQ(found.fault, "") << dialect.name;
    EXPECT_EQ(found.rows, both) << dialect.name;
    EXPECT_EQ(found.headings, dialect.headings) << dialect.name;
  }
}

TEST(CsvReader, NamesWhatItDoesNotRead) {
  using namespace std::string_literals;
  const std::pair<std::string, const char*> lines[] = {
      {"nan,5,6", "has \"nan\", which is no finite number"},
      {"4,-Inf,6", "has \"-Inf\", which is no finite number"},
      {"4,5", "has 2 numbers"},
      {"4,5,6,7", "has 4 numbers"},
      {"4,0,5,0,6,0", "has 6 numbers, as 3 with decimal commas"},
      {"4 5 6", "has blanks between its numbers"},
      {"4\t5\t6", "has tabs between its numbers"},
      {"4,\t5\t6", "has tabs and commas between its numbers"},
      {"4;5;6", "has semicolons between its numbers"},
      {"4,0;5,0;6,0", "has semicolons between its numbers, and commas in them"},
      {"4|5|6", "has bars between its numbers"},
      {"4,5,6,", "ends with a comma"},
      {"4,,6", "has an empty field"},
      {"4,5,6.O", "has \"6.O\", a number with something behind it"},
      {"4 m,5 m,6 m", "has \"4 m\", a number with something behind it"},
      {"4.0D0,5,6", "has \"4.0D0\", with an exponent as Fortran writes it"},
      {"1\u202F004,5,6", "has a blank within \"1\u202F004\", as some put between thousands"},
      {"1'004,5,6", "has a mark within \"1'004\", as some put between thousands"},
      {"\"4,0\",\"5,0\",\"6,0\"", "has a comma within a number: a decimal comma, or one between thousands"},
      {"id 7: 4,5,6", "has \"id 7: 4\", a name with its number"},
      {"(4,5,6)", "has \"(4\", with quotes or brackets around a number"},
      {"\u22124,5,6", "has a minus sign that is not the one of ASCII"},
      {"1e999,5,6", "has \"1e999\", which is out of range, or no number"},
      {"4,5,6 # top", "has a comment behind its numbers"},
      {"\"4,5,6", "has a quote that does not end there"},
      {"4,5,six", "has \"six\", which is no number"},
      {"\xFF\xFE"s + "4\0,\0005\0,\0006\0"s, "begins with a byte order mark of UTF-16"},
      {"4\0,\0005\0,\0006\0"s, "has NUL bytes, as text in UTF-16 and binary files have"},
      {"PK\3\4,5,6", "has control characters, as binary files have"},
  };
  for (const auto& [line, said] : lines) {
    for (const bool at_top : {true, false}) {
      const Contents found = contents_of(at_top ? line + "\n" + second : second + line + "\n");
      EXPECT_EQ(found.rows.size(), at_top ? 0u : 1u) << line;
      EXPECT_EQ(found.fault.find(at_top ? "line 1 is \"" : "line 2 is \""), 0u)
          << line << ": " << found.fault;
      EXPECT_TEXT(found.fault, std::string(": it ") + said) << line << ": " << found.fault;
      EXPECT_TRUE(found.fault.ends_with("; it must be three numbers")) << found.fault;
    }
  }
  // only the first lines are headings; files joined together
  EXPECT_TEXT(contents_of(second + "x,y,z\n" + second).fault, "has \"x\", which is no number");
  EXPECT_TEXT(contents_of(second + "\xEF\xBB\xBF" + second).fault, "line 2 is");
  EXPECT_TEXT(contents_of(second + "\xEF\xBB\xBF" + second).fault, "has a byte order mark");
}

TEST(CsvReader, CountsLinesWhateverEndsThem) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const std::string text =
        "# cloud" + end + "x,y,z" + end + end + second.substr(0, 13) + end + "4;5;6" + end;
    EXPECT_EQ(contents_of(text).fault.find("line 5 is \"4;5;6\""), 0u) << contents_of(text).fault;
  }
}

TEST(CsvReader, MotionsTakeSevenNumbersFromTheFirstLineOn) {
  const Units units;
  const std::string rest = "1,0,0,1,0,0,0\n2,0,0,2,0,0,0\n";
  EXPECT_EQ(read_motion_file("t,x,y,z,rx,ry,rz\n0,0,0,0,0,0,0\n" + rest, units).rows.size(), 3u);
  EXPECT_EQ(read_motion_file("t,x,y,z,rx,ry,rz\n0,0,0,0,0,0,0\n" + rest, units).headings, 1);
  EXPECT_EQ(read_motion_file("\xEF\xBB\xBF+0,0,0,\"0\",0,0,0\r" + rest, units).rows.size(), 3u);
  for (const char* first : {"0,0,0,0,0,0", "0;0;0;0;0;0;0", "0,0,0,0,0,0,0,", "nan,0,0,0,0,0,0"}) {
    const std::string error =
        tests::error_of<std::invalid_argument>([&] { read_motion_file(first + ("\n" + rest), units); });
    EXPECT_TRUE(error.starts_with("line 1 is \"" + std::string(first))) << error;
    EXPECT_TEXT(error, "it must be seven finite numbers");
  }
}

}  // namespace
}  // namespace silt::testing
