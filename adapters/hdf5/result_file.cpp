#include "adapters/hdf5/result_file.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <string_view>
#include <vector>

#include "adapters/hdf5/file.hpp"

namespace silt::adapters {
namespace {

using hdf5::File;
using hdf5::Handle;

/// Returns the first numbers or texts of an attribute.
std::string attribute_text(const File& file, hid_t owner, const std::string& name) {
  const Handle attribute(H5Aopen(owner, name.c_str(), H5P_DEFAULT), H5Aclose, file.path(),
                         "attribute " + name);
  const Handle type(H5Aget_type(attribute), H5Tclose, file.path(), "type of attribute " + name);
  const Handle space(H5Aget_space(attribute), H5Sclose, file.path(), "shape of attribute " + name);
  const auto n = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
  std::string text;
  if (H5Tget_class(type) == H5T_STRING) {
    if (H5Tis_variable_str(type) <= 0) return n == 1 ? file.text_in(owner, name) : "(texts)";
    std::vector<char*> values(n, nullptr);
    file.check(H5Aread(attribute, type, values.data()), "cannot read attribute " + name);
    for (const char* v : values) {
      if (!text.empty()) text += ", ";
      if (v) text += v;
    }
    H5Dvlen_reclaim(type, space, H5P_DEFAULT, values.data());
    return text;
  }
  if (H5Tget_class(type) != H5T_INTEGER && H5Tget_class(type) != H5T_FLOAT) return "(not a number)";
  std::vector<double> values(n);
  file.check(H5Aread(attribute, H5T_NATIVE_DOUBLE, values.data()), "cannot read attribute " + name);
  for (const double v : values) {
    char number[32];
    std::snprintf(number, sizeof number, "%s%.10g", text.empty() ? "" : ", ", v);
    text += number;
  }
  return text;
}

std::string attributes_text(const File& file, hid_t owner) {
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5A_info_t*, void* to) -> herr_t {
    static_cast<std::vector<std::string>*>(to)->push_back(name);
    return 0;
  };
  H5Aiterate2(owner, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names);
  std::string text;
  for (const auto& name : names) {
    text.append("    ").append(name).append(": ").append(attribute_text(file, owner, name)).append("\n");
  }
  return text;
}

std::string dataset_text(const File& file, const std::string& name) {
  const Handle data = file.dataset(name);
  const Handle type = file.type(data);
  const auto shape = file.shape(data);
  std::string text = "  " + name + " [";
  for (std::size_t d = 0; d < shape.size(); ++d) {
    if (d > 0) text += " x ";
    text += std::to_string(shape[d]);
  }
  text += "] ";
  const H5T_class_t kind = H5Tget_class(type);
  text += kind == H5T_FLOAT ? "float" : kind == H5T_INTEGER ? "integer" : "text";
  if (kind != H5T_STRING) text += std::to_string(8 * H5Tget_size(type));
  if (file.has_attribute(data, "unit")) text += ", " + file.text_in(data, "unit");
  return text + "\n";
}

struct Objects {
  std::vector<std::string> groups, datasets;
};

}  // namespace

std::filesystem::path step_path(const std::filesystem::path& folder, const std::string& name,
                                std::int64_t step, const std::string& suffix) {
  constexpr std::size_t digits = 12;
  std::string number = std::to_string(step);
  if (number.size() < digits) number.insert(0, digits - number.size(), '0');
  return folder / (name + "_" + number + suffix);
}

std::optional<std::int64_t> step_of(const std::filesystem::path& path, std::string_view name,
                                    std::string_view suffix) {
  const std::string file = path.filename().string();
  if (!file.starts_with(name) || !file.ends_with(suffix) || file.size() < name.size() + 2 + suffix.size() ||
      file[name.size()] != '_')
    return {};
  std::int64_t step = 0;
  const char *from = file.data() + name.size() + 1, *to = file.data() + file.size() - suffix.size();
  const auto [end, error] = std::from_chars(from, to, step);
  if (error != std::errc{} || end != to) return {};
  return step;
}

std::vector<StepFile> step_files(const std::filesystem::path& folder, std::string_view name,
                                 std::string_view suffix) {
  std::vector<StepFile> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (const auto step = step_of(entry.path(), name, suffix); step && entry.is_regular_file(error))
      found.push_back({*step, entry.path()});
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.step > b.step; });
  return found;
}

std::string describe_file(const std::filesystem::path& path) {
  const File file = File::open(path, false);
  Objects objects;
  const auto collect = [](hid_t, const char* name, const H5O_info_t* info, void* to) -> herr_t {
    auto& all = *static_cast<Objects*>(to);
    const std::string_view relative(name);
    std::string full(1, '/');
    if (relative != ".") full.append(relative);
    (info->type == H5O_TYPE_DATASET ? all.datasets : all.groups).push_back(full);
    return 0;
  };
  file.check(H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, collect, &objects, H5O_INFO_BASIC),
             "cannot list what is in it");
  std::string text = path.string() + "\n";
  for (const auto& name : objects.groups) {
    const Handle group = file.group(name);
    const std::string attributes = attributes_text(file, group);
    if (!attributes.empty()) text += "  " + name + "\n" + attributes;
  }
  for (const auto& name : objects.datasets) text += dataset_text(file, name);
  return text;
}

}  // namespace silt::adapters
