#include "coupler/case/case_file.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "coupler/case/case_error.hpp"
#include "coupler/case/case_overrides.hpp"
#include "coupler/case/case_sections.hpp"
#include "coupler/case/key_table.hpp"
#include "parallel/collectives.hpp"
#include "parallel/communicator.hpp"

namespace silt::coupler {

namespace fs = std::filesystem;

namespace {

/// Opens a file beside the case.
std::ifstream opened(const fs::path& directory, const fs::path& relative) {
  if (relative.is_absolute() || std::count(relative.begin(), relative.end(), fs::path("..")))
    throw std::invalid_argument(
        "it must lie in the directory of the case, which holds all that a run needs: copy it there");
  const std::string name = relative.string();
  if (std::any_of(name.begin(), name.end(), [](unsigned char c) { return std::iscntrl(c); }))
    throw std::invalid_argument("its name has a line break or another control character in it: rename it");
  std::ifstream stream;
  std::error_code ignored;
  if (fs::is_regular_file(directory / relative, ignored))  // to open anything else could wait forever
    stream.open(directory / relative, std::ios::binary);
  if (!stream.is_open())
    throw std::invalid_argument("there is no such file in the directory of the case, or it cannot be read");
  return stream;
}

std::string fingerprint_of(const std::string& name, std::uint64_t bytes, XXH64_hash_t hash) {
  return fmt::format("{}: {} bytes, XXH3 {:016x}", name, bytes, hash);
}

/// Reads a file, which may not lead out of the directory. std::invalid_argument says what is wrong with it.
AttachedFile read_attached(const fs::path& directory, const std::string& name) {
  std::ifstream stream = opened(directory, name);
  AttachedFile file{{std::istreambuf_iterator<char>(stream), {}}, "", {}};
  file.fingerprint =
      fingerprint_of(name, file.bytes.size(), XXH3_64bits(file.bytes.data(), file.bytes.size()));
  return file;
}

/// Looks at positions without keeping them; errors alike.
AttachedFile look_at_positions(const fs::path& directory, const std::string& name) {
  const PositionFile positions = position_file(name);
  std::ifstream stream = opened(directory, positions.file);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
  XXH3_64bits_reset(state.get());
  std::vector<char> piece(std::size_t{1} << 20);
  std::uint64_t bytes = 0;
  while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())) || stream.gcount() > 0) {
    bytes += static_cast<std::uint64_t>(stream.gcount());
    XXH3_64bits_update(state.get(), piece.data(), static_cast<std::size_t>(stream.gcount()));
  }
  AttachedFile file;
  file.fingerprint = fingerprint_of(name, bytes, XXH3_64bits_digest(state.get()));
  try {
    file.positions = look_through(directory, positions);
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(error.what());
  }
  if (file.positions.points == 0) throw std::invalid_argument("there is no point in it");
  return file;
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
  std::error_code ignored;
  if (fs::is_regular_file(file, ignored))  // to open anything else could wait forever
    if (std::ifstream stream(file, std::ios::binary); stream)
      return {std::istreambuf_iterator<char>(stream), {}};
  const auto names = cases_near(directory);
  throw CaseError(
      Place{file.string()},
      fmt::format("there is no such file, or it cannot be read; a case is a directory with a case.toml{}",
                  names.empty() ? "" : suggestion(directory.filename().string(), names)));
}

}  // namespace

const AttachedFile& CaseSource::file_named(const std::string& name) {
  const auto found = attached.find(name);
  if (found != attached.end()) return found->second;
  return attached.emplace(name, read_attached(directory(), name)).first->second;
}

const AttachedFile& CaseSource::positions_named(const std::string& name) {
  const auto found = attached.find(name);
  if (found != attached.end()) return found->second;
  return attached.emplace(name, look_at_positions(directory(), name)).first->second;
}

CaseSource read_source(const fs::path& directory) {
  const bool is_file = directory.extension() == ".toml";
  const fs::path folder = is_file                    ? directory
                          : directory.has_filename() ? directory
                                                     : directory.parent_path();
  const fs::path file = is_file ? directory : folder / "case.toml";
  return {file.string(), text_of(folder, file), {}};
}

void broadcast(MPI_Comm comm, CaseSource& source) {
  using parallel::broadcast;
  broadcast(comm, source.file);
  broadcast(comm, source.text);
  std::uint64_t files = source.attached.size();
  broadcast(comm, files);
  auto next = source.attached.begin();
  const int rank = parallel::rank_of(comm);
  for (std::uint64_t i = 0; i < files; ++i) {
    std::string name;
    AttachedFile file;
    if (rank == 0) std::tie(name, file) = *next++;
    broadcast(comm, name);
    broadcast(comm, file.bytes);
    broadcast(comm, file.fingerprint);
    broadcast(comm, file.positions);
    if (rank != 0) source.attached[name] = std::move(file);
  }
}

namespace {

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

constexpr std::tuple top_keys{
    Key{"title", &Case::title, Text{}, "a line for the log and the report", "none"},
    HandKey{"units", "table", "", required, "a table [units] with system = \"si\" or \"lattice\""},
    HandKey{"domain", "table", "", required, "a table [domain] with size and boundary"},
    HandKey{"run", "table", "", required, "a table [run] with steps or time"},
    HandKey{"fluid", "table", "", "none", "without it the run is dry: bodies alone"},
    HandKey{"gravity", "table", "", "0", "what acts on the bodies"},
    HandKey{"coupling", "table", "", "defaults", "how fluid and bodies are coupled"},
    HandKey{"contacts", "table", "", "defaults", "how bodies collide"},
    HandKey{"output", "table", "", "none", "what is written"},
    HandKey{"materials", "list of tables", "", "none", "of bodies and walls"},
    HandKey{"material_pairs", "list of tables", "", "none", "how two materials touch"},
    HandKey{"walls", "list of tables", "", "none", "curved walls"},
    HandKey{"shapes", "list of tables", "", "none", "of bodies"},
    HandKey{"bodies", "list of tables", "", "none", "bodies at given places"},
    HandKey{"fill", "list of tables", "", "none", "bodies that find their places by themselves"},
    HandKey{"outflow", "list of tables", "", "none", "boxes where bodies are taken out"},
    HandKey{"quantities", "list of tables", "", "none", "figures of the report"}};

void read_sections(TableReader reader, Case& scene) {
  read_keys(reader, scene, top_keys);
  if (constexpr std::size_t longest = 1000; scene.title.size() > longest)  // results carry it
    reader.fail("title", "title has {} bytes; at most {} are allowed", scene.title.size(), longest);
  read_units(reader, scene);
  read_domain(reader, scene);
  read_fluid(reader, scene);
  read_contacts(reader, scene);
  read_walls(reader, scene);
  read_shapes(reader, scene);
  read_bodies(reader, scene);
  read_fills(reader, scene);
  read_outflows(reader, scene);
  read_run(reader, scene);
  read_output(reader, scene);
  add_masks(scene);
  choose_collision(scene);
  read_quantities(reader, scene);
}

}  // namespace

std::string unit_on_page(Dimension d) {
  if (d == dimension::none) return "1";
  Units si;
  si.si = true;
  std::string text = si.unit_text(d);
  for (const auto& [digit, power] : {std::pair("2", "²"), std::pair("3", "³")})
    if (const auto at = text.find(digit); at != text.npos) text.replace(at, 1, power);
  return text;
}

std::vector<KeySection> case_keys() {
  std::vector<KeySection> all = {section_of("", top_keys)};
  for (const auto sections : {domain_sections, fluid_sections, contact_sections, wall_sections,
                              shape_sections, body_sections, output_sections, quantity_sections})
    for (KeySection& section : sections()) all.push_back(std::move(section));
  return all;
}

int index_of(TableReader& reader, std::string_view key, const std::string& name,
             const std::vector<std::string>& names, std::string_view what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<int>(found - names.begin());
  reader.fail(key, "{}: unknown {} '{}'{}", reader.path(key), what, name, suggestion(name, names));
  return -1;
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

Case read_case(const fs::path& directory, const std::vector<std::string>& overrides) {
  CaseSource source = read_source(directory);
  return read_case(source, overrides);
}

}  // namespace silt::coupler
