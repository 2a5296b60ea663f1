#include "coupler/case/case_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "coupler/case/case_keys.hpp"
#include "coupler/case/case_overrides.hpp"
#include "coupler/case/case_sections.hpp"
#include "coupler/case/case_source.hpp"
#include "coupler/case/choose_collision.hpp"

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

/// Where there are solid cells, fields tell them from fluid, asked for or not.
void add_masks(Case& scene) {
  if (!scene.has_surfaces()) return;
  const auto add = [](FieldsSpec& fields) {
    if (std::count(fields.quantities.begin(), fields.quantities.end(), Field::solid) == 0)
      fields.quantities.push_back(Field::solid);
  };
  add(scene.output.fields);
  for (FieldsSpec& slice : scene.output.slices) add(slice);
}

void read_sections(TableReader reader, Case& scene) {
  scene.title = reader.string("title").value_or("");
  if (constexpr std::size_t longest = 1000; scene.title.size() > longest)  // results carry it
    reader.fail("title",
                fmt::format("title has {} bytes; at most {} are allowed", scene.title.size(), longest));
  read_units(reader, scene);
  read_domain(reader, scene);
  read_fluid(reader, scene);
  read_contacts(reader, scene);
  read_walls(reader, scene.material_names, scene.walls);
  read_shapes(reader, scene);
  read_bodies(reader, scene);
  read_fills(reader, scene);
  read_outflows(reader, scene);
  read_run(reader, scene.steps, scene.steady, scene.balance_every);
  read_output(reader, scene.cells, scene.output);
  add_masks(scene);
  choose_collision(scene);
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
  CaseSource source{file, text, {}};
  return read_case(source, overrides);
}

Case read_case(CaseSource& source, const std::vector<std::string>& overrides) {
  const Node root = parsed(source.text, source.file, overrides);
  Case scene;
  scene.overrides = overrides;
  scene.directory = source.directory();

  ReadContext context;
  context.file = source.file;
  context.source = &source;
  read_sections({context, &root, "", Place{source.file}}, scene);
  context.report_unread(root, "");
  if (!context.errors.empty()) throw CaseError(std::move(context.errors));
  scene.warnings = std::move(context.warnings);
  scene.places = std::move(context.places);
  scene.files = std::move(context.files);
  scene.text = source.text;
  for (const std::string& file_read : scene.files) scene.text += fmt::format("\n# file {}", file_read);
  for (const std::string& argument : overrides) scene.text += "\n# " + override_text(argument);
  return scene;
}

std::map<std::string, std::vector<std::string>> keys_asked_for(const std::string& text) {
  const Node root = parsed(text, "", {});
  Case scene;
  CaseSource source;
  ReadContext context;
  context.source = &source;
  read_sections({context, &root, "", Place{}}, scene);
  std::map<std::string, std::vector<std::string>> keys;
  collect_known_keys(context, root, "", keys);
  return keys;
}

Case read_case(const fs::path& directory, const std::vector<std::string>& overrides) {
  CaseSource source = read_source(directory);
  return read_case(source, overrides);
}

}  // namespace silt::coupler
