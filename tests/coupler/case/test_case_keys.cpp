// cases/README.md against the program: its tables name every key that the reader asks for and no other, every
// type of a shape and of a quantity with the keys it takes, and no cell is long.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <set>
#include <sstream>

#include "coupler/case/case_keys.hpp"
#include "coupler/case/quantity_types.hpp"
#include "tests/coupler/case/case_text.hpp"

namespace silt::coupler::testing {
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

std::map<std::string, Names> documented_keys() {
  std::map<std::string, Names> keys;
  for (const Row& row : rows_of_readme())
    if (row.cells.size() == key_columns)
      for (const std::string& name : names_in(row.cells[0])) keys[row.section].insert(name);
  return keys;
}

/// The row of a type in the table of types of a section; none for one that is not there.
const Row* row_of_type(const std::vector<Row>& rows, const std::string& section, std::string_view type) {
  const std::string first = fmt::format("`\"{}\"`", type);
  for (const Row& row : rows)
    if (row.section == section && row.cells.size() < key_columns && row.cells[0] == first) return &row;
  return nullptr;
}

/// A text with every table but shapes and quantities: those depend on their types.
constexpr const char* every_table = R"(
units = { system = "si" }
domain.boundary.x = [{ type = "moving" }, { type = "pressure-outlet" }]
fluid.initial.type = "uniform"
gravity = {}
coupling = {}
contacts = {}
materials = [{ name = "steel" }]
material_pairs = [{ between = ["steel", "steel"] }]
walls = [{ type = "tube" }, { type = "mesh", motion = { oscillation = {} } }]
shapes = []
bodies = [{ axis_angle = {} }]
fill = [{}]
outflow = [{}]
run.steady = {}
run.balance = {}
output = { fields = {}, bodies = {}, checkpoint = {}, report = {} }
quantities = []
)";

Names as_set(const std::vector<std::string>& names) {
  return {names.begin(), names.end()};
}

Names keys_of_shape(const std::string& type) {
  return as_set(keys_asked_for(fmt::format("[[shapes]]\ntype = \"{}\"\n", type)).at("shapes"));
}

Names keys_of_quantity(std::string_view type) {
  return as_set(keys_asked_for(fmt::format("[[quantities]]\ntype = \"{}\"\n", type)).at("quantities"));
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

TEST(CaseKeys, TablesNameEveryKeyOfEverySection) {
  const auto documented = documented_keys();
  const auto known = keys_asked_for(every_table);
  for (const auto& [section, keys] : known)
    EXPECT_EQ(listed(documented.contains(section) ? documented.at(section) : Names{}), listed(as_set(keys)))
        << "cases/README.md, section '" << section << "': left, its table; right, what the program reads";
  for (const auto& [section, keys] : documented)
    if (section != "shapes" && section != "shapes.parts" && section != "quantities") {
      EXPECT_TRUE(known.contains(section)) << "no section '" << section << "' is read";
    }
}

TEST(CaseKeys, EveryTypeOfAShapeHasItsKeys) {
  const auto documented = documented_keys();
  const std::vector<Row> rows = rows_of_readme();
  const std::vector<std::string> types = shape_types();
  CaseText c;
  c.shapes = shape_of("ball", "?", "");
  const std::string unknown = c.fault();
  EXPECT_NE((unknown + "\n").find("must be one of " + joined(types) + "\n"), unknown.npos)
      << "the types in cases/README.md are not those of\n"
      << unknown;
  Names all = {"name", "type"};
  for (const std::string& type : types) {
    Names keys = {"name", "type"};
    for (const std::string& key : names_in(row_of_type(rows, "shapes", type)->cells[1])) keys.insert(key);
    EXPECT_EQ(listed(keys), listed(keys_of_shape(type))) << type;
    all.insert(keys.begin(), keys.end());
  }
  EXPECT_EQ(listed(documented.at("shapes")), listed(all));
  const auto part = keys_asked_for("[[shapes]]\ntype = \"compound\"\nparts = [{ type = \"sphere\" }]\n");
  Names keys = keys_of_shape("sphere");
  keys.erase("name");
  for (const std::string& key : documented.at("shapes.parts")) keys.insert(key);
  EXPECT_EQ(listed(keys), listed(as_set(part.at("shapes.parts"))));
}

TEST(CaseKeys, EveryTypeOfAQuantityHasItsRow) {
  const std::vector<Row> rows = rows_of_readme();
  Names all = {"name", "type"};
  std::size_t types = 0;
  for (const Row& row : rows) types += row.section == "quantities" && row.cells.size() < key_columns;
  EXPECT_EQ(types, quantity_types.size());
  for (const QuantityType& type : quantity_types) {
    const Row* row = row_of_type(rows, "quantities", type.name);
    ASSERT_TRUE(row) << type.name << " is missing in cases/README.md";
    Names keys = {"name", "type"};
    for (const std::string& key : names_in(row->cells[1])) keys.insert(key);
    EXPECT_EQ(listed(keys), listed(keys_of_quantity(type.name))) << type.name;
    EXPECT_EQ(row->cells[2], type.meaning) << type.name;
    all.insert(keys.begin(), keys.end());
  }
  EXPECT_EQ(listed(documented_keys().at("quantities")), listed(all));
}

TEST(CaseKeys, NoCellIsLong) {
  constexpr std::size_t longest = 200;  // bytes
  for (const Row& row : rows_of_readme())
    for (const std::string& cell : row.cells) EXPECT_LE(cell.size(), longest) << cell;
}

}  // namespace
}  // namespace silt::coupler::testing
