// The tables of keys: cases/README.md has them word for word, the reader knows the keys of every table and no
// other, and every type of a shape and of a quantity has the keys it takes.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <regex>
#include <set>
#include <sstream>

#include "silt/case/case_file.hpp"
#include "silt/case/quantity_spec.hpp"
#include "tests/errors.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::testing {
namespace {

using Names = std::set<std::string>;

struct Row {
  std::string section;  // the heading it stands under: "fluid", "bodies", "" for the file itself
  std::vector<std::string> cells;
};

/// "| a | b \| c |" -> "a", "b | c"
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::string cell;
  for (std::size_t i = 1; i < line.size(); ++i) {
    if (line[i] == '\\' && i + 1 < line.size() && line[i + 1] == '|') {
      cell += line[++i];
    } else if (line[i] == '|') {
      const auto first = cell.find_first_not_of(' ');
      cells.push_back(first == cell.npos ? "" : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
      cell.clear();
    } else {
      cell += line[i];
    }
  }
  return cells;
}

/// The words between backticks.
std::vector<std::string> names_in(const std::string& text) {
  std::vector<std::string> names;
  for (auto open = text.find('`'); open != text.npos; open = text.find('`', open)) {
    const auto close = text.find('`', open + 1);
    names.push_back(text.substr(open + 1, close - open - 1));
    open = close + 1;
  }
  return names;
}

/// The rows of all tables below a heading of the third level, without their heads.
std::vector<Row> rows_of_readme() {
  std::istringstream lines(file_text(std::filesystem::path(SILT_SOURCE_DIR) / "cases/README.md"));
  std::vector<Row> rows;
  std::string section;
  bool in_body = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("### ")) {
      const auto names = names_in(line);
      section = names.empty() ? "" : names[0];
      std::erase_if(section, [](char c) { return c == '[' || c == ']'; });
    }
    if (!line.starts_with("|")) in_body = false;
    if (in_body) rows.push_back({section, cells_of(line)});
    if (line.starts_with("|---")) in_body = true;
  }
  return rows;
}

constexpr std::size_t key_columns = 5;  // key, type, unit, default, meaning; tables of types have fewer

/// A cell as the table of the program has it: without backticks, and of links their text.
std::string plain(std::string cell) {
  std::erase(cell, '`');
  return std::regex_replace(cell, std::regex(R"(\[([^\[\]]*)\]\([^()]*\))"), "$1");
}

/// The rows of the page's tables of keys, a line a key, by section.
std::map<std::string, std::string> documented_rows() {
  std::map<std::string, std::string> rows;
  for (const Row& row : rows_of_readme())
    if (row.cells.size() == key_columns)
      for (const std::string& name : names_in(row.cells[0]))
        rows[row.section] += fmt::format("{} | {} | {} | {} | {}\n", name, plain(row.cells[1]), row.cells[2],
                                         plain(row.cells[3]), plain(row.cells[4]));
  return rows;
}

std::map<std::string, std::string> rows_of_program() {
  std::map<std::string, std::string> rows;
  for (const KeySection& section : case_keys())
    for (const KeyText& key : section.keys)
      rows[section.path] +=
          fmt::format("{} | {} | {} | {} | {}\n", key.name, key.type, key.unit, key.fallback, key.meaning);
  return rows;
}

/// The row of a type in the table of types of a section; none for one that is not there.
const Row* row_of_type(const std::vector<Row>& rows, const std::string& section, std::string_view type) {
  const std::string first = fmt::format("`\"{}\"`", type);
  for (const Row& row : rows)
    if (row.section == section && row.cells.size() < key_columns && row.cells[0] == first) return &row;
  return nullptr;
}

/// A text with every table but shapes and quantities, which depend on their types; in each is a key that none
/// has.
constexpr const char* every_table = R"(
zzz = 1
units = { system = "si", zzz = 1 }
domain = { zzz = 1, boundary = { zzz = 1, x = [{ type = "moving", zzz = 1 }, { type = "pressure-outlet", zzz = 1 }] } }
fluid = { zzz = 1, initial = { type = "uniform", zzz = 1 } }
heat = { zzz = 1 }
coarsening = { zzz = 1, fine = [{ zzz = 1 }] }
gravity = { zzz = 1, over_time = { zzz = 1 } }
initial = { zzz = 1 }
coupling = { zzz = 1 }
contacts = { zzz = 1 }
material_pairs = [{ between = ["steel", "steel"], zzz = 1 }]
walls = [{ type = "tube", zzz = 1 }, { type = "mesh", zzz = 1, motion = { zzz = 1 } }]
shapes = []
bodies = [{ zzz = 1, orientation = { zzz = 1 }, positions = { zzz = 1 } }]
fill = [{ zzz = 1, diameter = { smallest = 1, zzz = 1 } }]
springs = [{ zzz = 1 }]
outflow = [{ zzz = 1 }]
run = { zzz = 1, steady = { zzz = 1 }, balance = { zzz = 1 } }
quantities = []
[output]
zzz = 1
fields = { zzz = 1 }
slices = [{ zzz = 1 }]
series = [{ zzz = 1 }]
probes = [{ line = [], zzz = 1 }]
mean = { zzz = 1 }
bodies = { zzz = 1 }
checkpoint = { zzz = 1 }
report = { zzz = 1 }
)";

Names as_set(const std::string& joined_names) {
  Names names;
  std::istringstream stream(joined_names);
  for (std::string name; stream >> name;) names.insert(name.substr(0, name.find(',')));
  return names;
}

/// The keys that are known where the key zzz is not, by section.
std::map<std::string, Names> known_keys(const std::string& text) {
  const std::regex complaint(
      R"(unknown key 'zzz' (?:at the top of the file|in \[([a-z_.]*)\]); known: (.*))");
  std::istringstream lines(error_of([&] { read_case_text(text); }));
  std::map<std::string, Names> keys;
  std::smatch found;
  for (std::string line; std::getline(lines, line);)
    if (std::regex_search(line, found, complaint)) keys[found[1]].merge(as_set(found[2]));
  return keys;
}

Names keys_of_shape(const std::string& type) {
  return known_keys(fmt::format("[[shapes]]\ntype = \"{}\"\nzzz = 1\n", type)).at("shapes");
}

Names keys_of_quantity(std::string_view type) {
  return known_keys(fmt::format("[[quantities]]\ntype = \"{}\"\nzzz = 1\n", type)).at("quantities");
}

std::vector<std::string> shape_types() {
  std::vector<std::string> types;
  for (const Row& row : rows_of_readme())
    if (row.section == "shapes" && row.cells.size() < key_columns)
      types.push_back(row.cells[0].substr(2, row.cells[0].size() - 4));
  return types;
}

std::string listed(const Names& names) {
  return joined(std::vector<std::string>(names.begin(), names.end()));
}

Names keys_of_section(const std::string& path) {
  Names names;
  for (const KeySection& section : case_keys())
    for (const KeyText& key : section.keys)
      if (section.path == path) names.insert(key.name);
  return names;
}

TEST(CaseKeys, ThePageHasTheTablesOfTheProgram) {
  const auto documented = documented_rows(), tables = rows_of_program();
  for (const auto& [section, rows] : tables)
    EXPECT_EQ(documented.contains(section) ? documented.at(section) : "", rows)
        << "cases/README.md, section '" << section << "'";
  for (const auto& [section, rows] : documented)
    EXPECT_TRUE(tables.contains(section)) << "no section '" << section << "' is read";
}

TEST(CaseKeys, TheReaderKnowsTheKeysOfEveryTable) {
  const auto known = known_keys(every_table);
  for (const KeySection& section : case_keys())
    if (section.path != "shapes" && section.path != "shapes.parts" && section.path != "quantities") {
      ASSERT_TRUE(known.contains(section.path)) << section.path;
      EXPECT_EQ(listed(known.at(section.path)), listed(keys_of_section(section.path))) << section.path;
    }
}

TEST(CaseKeys, EveryTypeOfAShapeHasItsKeys) {
  const std::vector<Row> rows = rows_of_readme();
  const std::vector<std::string> types = shape_types();
  CaseText c;
  c.shapes = shape_of("ball", "?", "");
  const std::string unknown = c.fault();
  EXPECT_TEXT((unknown + "\n"), "must be one of " + joined(types) + "\n")
      << "the types in cases/README.md are not those of\n"
      << unknown;
  Names all = {"name", "type"};
  for (const std::string& type : types) {
    Names keys = {"name", "type"};
    for (const std::string& key : names_in(row_of_type(rows, "shapes", type)->cells[1])) keys.insert(key);
    EXPECT_EQ(listed(keys), listed(keys_of_shape(type))) << type;
    all.insert(keys.begin(), keys.end());
  }
  EXPECT_EQ(listed(keys_of_section("shapes")), listed(all));
  const auto part = known_keys("[[shapes]]\ntype = \"compound\"\nparts = [{ type = \"sphere\", zzz = 1 }]\n");
  Names keys = keys_of_shape("sphere");
  keys.erase("name");
  keys.merge(keys_of_section("shapes.parts"));
  EXPECT_EQ(listed(keys), listed(part.at("shapes.parts")));
}

TEST(CaseKeys, EveryTypeOfAQuantityHasItsRow) {
  const std::vector<Row> rows = rows_of_readme();
  const Names of_every_type = {"name", "type", "over", "deviation"};
  Names all = of_every_type;
  std::size_t types = 0;
  for (const Row& row : rows) types += row.section == "quantities" && row.cells.size() < key_columns;
  EXPECT_EQ(types, quantity_types.size());
  for (const QuantityType& type : quantity_types) {
    const Row* row = row_of_type(rows, "quantities", type.name);
    ASSERT_TRUE(row) << type.name << " is missing in cases/README.md";
    Names keys = of_every_type;
    for (const std::string& key : names_in(row->cells[1])) keys.insert(key);
    EXPECT_EQ(listed(keys), listed(keys_of_quantity(type.name))) << type.name;
    EXPECT_EQ(row->cells[2], type.meaning) << type.name;
    all.insert(keys.begin(), keys.end());
  }
  EXPECT_EQ(listed(keys_of_section("quantities")), listed(all));
}

TEST(CaseKeys, NoCellIsLong) {
  constexpr std::size_t longest = 200;  // bytes
  for (const Row& row : rows_of_readme())
    for (const std::string& cell : row.cells) EXPECT_LE(cell.size(), longest) << cell;
}

}  // namespace
}  // namespace silt::testing
