#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "rigid/math/elementary.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case_sections.hpp"
#include "silt/case/fill_room.hpp"

namespace silt {
namespace {

constexpr int strips = 32, most_rows = 64;

struct DiameterSpec {
  double smallest = 0, largest = 0;
  bool by_mass = false;
};

constexpr Number positive_length{dimension::length, range::above(0)};
constexpr std::tuple range_keys{
    Key{"smallest", &DiameterSpec::smallest, positive_length,
        "the smallest diameter; all diameters up to the largest are equally frequent", "one of two"},
    Key{"largest", &DiameterSpec::largest, positive_length, "the largest diameter; not with a table",
        required}};
constexpr std::tuple diameter_keys{
    Key{"by", &DiameterSpec::by_mass, Choice{coupler::names_of<bool>("number", "mass")},
        "whether the distribution is one of the number of bodies or of their mass"},
    HandKey{"table", "[[diameter, share], …]", "m, 1", "one of two",
            "the diameters, in ascending order, and the share of each"}};

void read_range(TableReader& table, DiameterSpec& spec) {
  read_keys(table, spec, range_keys);
  if (spec.smallest > 0 && spec.largest > 0 && !(spec.smallest < spec.largest))
    table.refuse("largest", "above " + table.path("smallest"));
}

std::vector<SizeShare> rows_of(TableReader& table) {
  const Node* list = table.find("table");
  std::vector<SizeShare> rows;
  if (!list) return rows;
  for (const Node& row : list->children) {
    const auto numbers = row.numbers(2);
    const double last = rows.empty() ? 0 : rows.back().diameter;
    if (!numbers || !((*numbers)[0] > last) || !((*numbers)[1] > 0)) break;
    rows.push_back({(*numbers)[0], (*numbers)[1]});
  }
  if (rows.empty() || rows.size() != list->children.size() || rows.size() > most_rows) {
    table.refuse("table", fmt::format("a list of 1 to {} pairs, [[diameter, share], ...], both above 0, in "
                                      "ascending order of diameters",
                                      most_rows));
    return {};
  }
  for (SizeShare& row : rows) row.diameter /= table.context().units.cell_size;
  return rows;
}

/// Integrates number and cubed diameter over a strip by Simpson's rule, or mass for distributions by mass.
SizeShare strip_of(const DiameterSpec& spec, double low, double high) {
  constexpr int intervals = 64;
  const double width = (high - low) / intervals;
  double number = 0, volume = 0;
  for (int i = 0; i <= intervals; ++i) {
    const double d = low + i * width, cube = d * d * d;
    const double weight = i == 0 || i == intervals ? 1 : i % 2 ? 4 : 2;
    const double density = weight * width / 3;
    number += spec.by_mass ? density / cube : density;
    volume += spec.by_mass ? density : density * cube;
  }
  return {number > 0 ? rigid::elementary::cbrt(volume / number) : low, number};
}

std::vector<SizeShare> strips_of(const DiameterSpec& spec) {
  const double step = rigid::elementary::log(spec.largest / spec.smallest) / strips;
  std::vector<SizeShare> sizes;
  for (int k = 0; k < strips; ++k)
    sizes.push_back(strip_of(spec, spec.smallest * rigid::elementary::exp(k * step),
                             spec.smallest * rigid::elementary::exp((k + 1) * step)));
  return sizes;
}

/// `entry` is a fill, or bodies that continue another run.
template <class Entry>
void add_shapes(Case& setup, Entry& fill, const std::vector<SizeShare>& sizes, bool may_replace) {
  const int given = fill.shape;
  const rigid::Shape form = setup.shapes[given];
  const rigid::Vec3 origin = setup.shape_origins[given];
  const double diameter = rigid::elementary::cbrt(6 / std::numbers::pi * rigid::mass_properties(form).volume);
  double share = 0;
  fill.sizes.clear();
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double factor = sizes[i].diameter / diameter;
    const bool replaces = may_replace && i + 1 == sizes.size();
    if (!replaces) {
      setup.shapes.push_back(form), setup.shape_origins.push_back(origin);
      setup.shape_names.push_back(std::string(setup.shape_names[given]));
    }
    fill.shape = replaces ? given : static_cast<int>(setup.shapes.size()) - 1;
    setup.shapes[fill.shape] = rigid::scaled(form, factor);
    setup.shape_origins[fill.shape] = factor * origin;
    fill.sizes.push_back({fill.shape, share += sizes[i].share});
  }
  fill.sizes.back().up_to = 1;
}

}  // namespace

KeySection fill_size_section() {
  return section_of("fill.diameter", range_keys, diameter_keys);
}

std::vector<SizeShare> read_fill_sizes(TableReader& fill) {
  TableReader table = fill.table("diameter");
  if (!table.present()) return {};
  DiameterSpec spec;
  const std::size_t errors = table.context().errors.size();
  read_keys(table, spec, diameter_keys);
  const std::string given = table.one_of({"smallest", "table"}, true, "the sizes of the bodies");
  if (given == "smallest") read_range(table, spec);
  std::vector<SizeShare> sizes;
  if (given == "table") {
    table.refuse_given({"largest"},
                       "{key} goes with {table}.smallest; a table has its sizes, remove the key");
    sizes = rows_of(table);
    for (SizeShare& size : sizes)
      if (spec.by_mass) size.share /= rigid::elementary::power(size.diameter, 3);
  } else if (table.context().errors.size() == errors) {
    sizes = strips_of(spec);
  }
  double all = 0;
  for (const SizeShare& size : sizes) all += size.share;
  for (SizeShare& size : sizes) size.share /= all;
  return sizes;
}

void set_fill_sizes(Case& setup, const std::vector<std::vector<SizeShare>>& of_fills,
                    const std::vector<std::vector<SizeShare>>& of_continued) {
  std::vector<bool> used(setup.shapes.size());
  if (used.empty()) return;
  setup.for_each_given([&](const BodySpec& body, std::uint64_t) { used[body.shape] = true; });
  const auto of_one_size = [&](auto& entries, const auto& sizes) {
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      entries[i].sizes = {{entries[i].shape, 1}};
      if (sizes[i].empty()) used[entries[i].shape] = true;
    }
  };
  const auto of_many = [&](auto& entries, const auto& sizes) {
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      if (sizes[i].empty()) continue;
      const int given = entries[i].shape;
      add_shapes(setup, entries[i], sizes[i], !used[given]);
      used[given] = true;
    }
  };
  of_one_size(setup.fills, of_fills), of_one_size(setup.continued, of_continued);
  of_many(setup.fills, of_fills), of_many(setup.continued, of_continued);
}

double mean_volume(const Case& setup, const FillSpec& fill) {
  double volume = 0, below = 0;
  for (const FillSize& size : fill.sizes) {
    volume += (size.up_to - below) * rigid::mass_properties(setup.shapes[size.shape]).volume;
    below = size.up_to;
  }
  return volume;
}

}  // namespace silt
