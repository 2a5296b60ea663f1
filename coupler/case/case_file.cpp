#include "coupler/case/case_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "coupler/case/case_keys.hpp"
#include "coupler/case/case_overrides.hpp"
#include "coupler/case/case_sections.hpp"

namespace silt::coupler {
namespace {

namespace fs = std::filesystem;

Node parsed(const std::string& text, const std::string& file, const std::vector<std::string>& overrides) {
  Node root;
  try {
    root = adapters::parse_document(text, file);
  } catch (const adapters::SyntaxError& error) {
    throw CaseError(error.place, fmt::format("this is not TOML: {}", error.what()));
  }
  for (const std::string& argument : overrides) apply_override(root, argument);
  return root;
}

// Directories with a case.toml beside the one asked for, or below the place it was asked from.
std::vector<std::string> cases_near(const fs::path& directory) {
  std::vector<std::string> names;
  std::error_code ignored;
  const fs::path parent = directory.has_parent_path() ? directory.parent_path() : fs::path(".");
  for (const auto& entry : fs::directory_iterator(parent, ignored))
    if (fs::exists(entry.path() / "case.toml", ignored)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string text_of(const fs::path& directory, const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (stream && fs::is_regular_file(file)) return {std::istreambuf_iterator<char>(stream), {}};
  const auto names = cases_near(directory);
  throw CaseError(
      Place{file.string()},
      fmt::format("there is no such file, or it cannot be read; a case is a directory with a case.toml{}",
                  names.empty() ? "" : suggestion(directory.filename().string(), names)));
}

void read_sections(TableReader reader, Case& scene) {
  scene.title = reader.string("title").value_or("");
  read_units(reader, scene);
  read_domain(reader, scene);
  read_fluid(reader, scene);
  read_contacts(reader, scene);
  read_walls(reader, scene.material_names, scene.walls);
  read_shapes(reader, scene.shape_names, scene.shapes);
  read_bodies(reader, scene);
  read_fills(reader, scene);
  read_run(reader, scene.steps, scene.steady);
  read_output(reader, scene.output);
  read_quantities(reader, {scene.cells, scene.kind_names, scene.walls}, scene.quantities);
}

void collect_known_keys(const ReadContext& context, const Node& table, const std::string& path,
                        std::map<std::string, std::vector<std::string>>& keys) {
  if (const auto asked = context.known_keys.find(&table); asked != context.known_keys.end())
    for (const std::string& key : asked->second)
      if (auto& all = keys[path]; std::count(all.begin(), all.end(), key) == 0) all.push_back(key);
  for (const Node& child : table.children)
    collect_known_keys(context, child, path_of_child(table, path, child), keys);
}

}  // namespace

int index_of(TableReader& reader, std::string_view key, const std::string& name,
             const std::vector<std::string>& names, std::string_view what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<int>(found - names.begin());
  reader.fail(key,
              fmt::format("{}: unknown {} '{}'{}", reader.path(key), what, name, suggestion(name, names)));
  return -1;
}

Place Case::place(std::string path) const {
  for (;;) {
    if (const auto found = places.find(path); found != places.end()) return found->second;
    const auto cut = path.find_last_of(".[");
    if (cut == path.npos) return {(directory / "case.toml").string()};
    path.resize(cut);
  }
}

Case read_case_text(const std::string& text, const std::string& file,
                    const std::vector<std::string>& overrides) {
  const Node root = parsed(text, file, overrides);
  Case scene;
  scene.overrides = overrides;
  scene.directory = fs::path(file).parent_path();

  ReadContext context;
  context.file = file;
  context.directory = scene.directory;
  read_sections({context, &root, "", Place{file}}, scene);
  context.report_unread(root, "");
  if (!context.errors.empty()) throw CaseError(std::move(context.errors));
  scene.places = std::move(context.places);
  scene.files = std::move(context.files);
  scene.text = text;
  for (const std::string& file_read : scene.files) scene.text += fmt::format("\n# file {}", file_read);
  for (const std::string& argument : overrides) scene.text += fmt::format("\n# --set {}", argument);
  return scene;
}

std::map<std::string, std::vector<std::string>> keys_asked_for(const std::string& text) {
  const Node root = parsed(text, "", {});
  Case scene;
  ReadContext context;
  read_sections({context, &root, "", Place{}}, scene);
  std::map<std::string, std::vector<std::string>> keys;
  collect_known_keys(context, root, "", keys);
  return keys;
}

Case read_case(const fs::path& directory, const std::vector<std::string>& overrides) {
  const bool is_file = directory.extension() == ".toml";
  const fs::path folder = is_file                    ? directory
                          : directory.has_filename() ? directory
                                                     : directory.parent_path();
  const fs::path file = is_file ? directory : folder / "case.toml";
  return read_case_text(text_of(folder, file), file.string(), overrides);
}

}  // namespace silt::coupler
