#include "silt/case/case_file.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <tuple>

#include "parallel/collectives.hpp"
#include "parallel/communicator.hpp"
#include "silt/case/case_error.hpp"
#include "silt/case/case_reader.hpp"
#include "silt/case/case_sections.hpp"

namespace silt {

namespace fs = std::filesystem;

namespace {

/// Opens a file in the directory of the case.
std::ifstream opened(const fs::path& directory, const fs::path& relative) {
  if (relative.is_absolute() || std::ranges::count(relative, fs::path("..")))
    throw std::invalid_argument(
        "it must lie in the directory of the case, which holds all that a run needs: copy it there");
  const std::string name = relative.string();
  if (std::ranges::any_of(name, [](unsigned char c) { return std::iscntrl(c); }))
    throw std::invalid_argument("its name has a line break or another control character in it: rename it");
  std::ifstream stream;
  std::error_code ignored;
  if (fs::is_regular_file(directory / relative, ignored))  // opening anything else could block
    stream.open(directory / relative, std::ios::binary);
  if (!stream.is_open())
    throw std::invalid_argument("there is no such file in the directory of the case, or it cannot be read");
  return stream;
}

/// Reads a file of the directory and keeps its bytes if wanted. Throws std::invalid_argument.
AttachedFile read_attached(const fs::path& directory, const std::string& name, const fs::path& path,
                           bool keep) {
  std::ifstream stream = opened(directory, path);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
  XXH3_64bits_reset(state.get());
  std::vector<char> piece(std::size_t{1} << 20);
  std::uint64_t bytes = 0;
  AttachedFile file;
  while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())) || stream.gcount() > 0) {
    const auto count = static_cast<std::size_t>(stream.gcount());
    bytes += count;
    XXH3_64bits_update(state.get(), piece.data(), count);
    if (keep) file.bytes.append(piece.data(), count);
  }
  file.fingerprint = fmt::format("{}: {} bytes, XXH3 {:016x}", name, bytes, XXH3_64bits_digest(state.get()));
  return file;
}

/// Summarises a file of positions. Throws likewise.
AttachedFile look_at_positions(const fs::path& directory, const std::string& name) {
  const PositionFile positions = position_file(name);
  AttachedFile file = read_attached(directory, name, positions.file, false);
  try {
    file.positions = scan(directory, positions);
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(error.what());
  }
  if (file.positions.points == 0) throw std::invalid_argument("there is no point in it");
  return file;
}

// Directories with a case.toml beside the requested one, or below the current one.
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
  if (fs::is_regular_file(file, ignored))  // opening anything else could block
    if (std::ifstream stream(file, std::ios::binary); stream)
      return {std::istreambuf_iterator<char>(stream), {}};
  const auto names = cases_near(directory);
  throw CaseError(
      Place{file.string()},
      fmt::format("there is no such file, or it cannot be read; a case is a directory with a case.toml{}",
                  names.empty() ? "" : suggestion(directory.filename().string(), names)));
}

/// Adds `solid` to fields, requested or not, if the case has solid cells.
void add_masks(Case& setup) {
  if (!setup.has_surfaces()) return;
  const auto add = [](FieldsSpec& fields) {
    if (std::ranges::count(fields.quantities, Field::solid) == 0) fields.quantities.push_back(Field::solid);
  };
  add(setup.output.fields);
  for (FieldsSpec& slice : setup.output.slices) add(slice);
}

bool weighs_nothing(const Case& setup) {
  return !setup.gravity.isZero(0) && !setup.start && !(setup.heat && setup.heat->expansion != 0) &&
         std::ranges::none_of(entries_of(setup), [&](const Entry& entry) {
           return entry.is_free() && (!setup.fluid || entry.density != 1);
         });
}

constexpr IdleInCase without_free_bodies{[](const Case& setup) { return !setup.has_free_bodies(); },
                                         "contacts move free bodies, and the case has none; remove it"};
constexpr std::tuple top_keys{
    Key{"title", &Case::title, Text{}, "a line for the log and the report", "none"},
    HandKey{"units", "table", "", required, "a table [units] with system = \"si\" or \"lattice\""},
    HandKey{"domain", "table", "", required, "a table [domain] with size and boundary"},
    HandKey{"run", "table", "", required, "a table [run] with steps or time"},
    HandKey{"fluid", "table", "", "none", "without it the run is dry: bodies alone"},
    HandKey{"heat", "table", "", "none", "the temperature of the fluid"},
    HandKey{"coarsening", "table", "", "none", "where cells of the fluid may be coarser",
            IdleInCase{[](const Case& setup) { return setup.coarsening && keeps_all_fine(setup); },
                       "a box of coarsening.fine keeps all cells finest; remove one of them"}},
    HandKey{
        "gravity", "table", "", "0", "what acts on the bodies",
        IdleInCase{[](const Case& setup) { return weighs_nothing(setup) && setup.has_free_bodies(); },
                   "all free bodies are as heavy as the fluid"},
        IdleInCase{[](const Case& s) { return weighs_nothing(s) && !s.has_free_bodies() && !s.heat; },
                   "it acts on free bodies, and the case has none; a pressure gradient is fluid.body_force"}},
    HandKey{"initial", "table", "", "none", "another run, from whose end this one starts"},
    HandKey{"coupling", "table", "", "defaults", "how fluid and bodies are coupled",
            IdleInCase{[](const Case& setup) { return setup.fluid && !setup.has_surfaces(); },
                       "there are no bodies and no [[walls]] in the fluid; remove it"}},
    HandKey{"contacts", "table", "", "defaults", "how bodies collide", without_free_bodies},
    HandKey{"output", "table", "", "none", "what is written"},
    HandKey{"material_pairs", "list of tables", "", "none", "how two materials touch", without_free_bodies},
    HandKey{"walls", "list of tables", "", "none", "curved walls"},
    HandKey{"shapes", "list of tables", "", "none", "of bodies"},
    HandKey{"bodies", "list of tables", "", "none", "bodies at given places"},
    HandKey{"fill", "list of tables", "", "none", "bodies at places that the program finds"},
    HandKey{"springs", "list of tables", "", "none", "springs, dampers and joints between bodies"},
    HandKey{"outflow", "list of tables", "", "none", "boxes that remove bodies"},
    HandKey{"quantities", "list of tables", "", "none", "figures of the report"}};

void read_sections(TableReader reader, Case& setup) {
  read_keys(reader, setup, top_keys);
  if (constexpr std::size_t longest = 1000; setup.title.size() > longest)  // results contain it
    reader.fail("title", "title has {} bytes; at most {} are allowed", setup.title.size(), longest);
  read_domain(reader, setup);
  read_fluid(reader, setup);
  read_contacts(reader, setup);
  read_walls(reader, setup);
  read_shapes(reader, setup);
  read_bodies(reader, setup);
  look_for_idle_pairs(reader, setup);
  read_heat(reader, setup);
  read_springs(reader, setup);
  read_coarsening(reader, setup);
  read_output(reader, setup);
  add_masks(setup);
  if (reader.context().errors.empty()) choose_collision(setup);
  read_quantities(reader, setup);
}

}  // namespace

const AttachedFile& CaseSource::file_named(const std::string& name, bool of_positions) {
  if (const auto found = attached.find(name); found != attached.end()) return found->second;
  return attached[name] = of_positions ? look_at_positions(directory(), name)
                                       : read_attached(directory(), name, name, true);
}

CaseSource read_source(const fs::path& directory) {
  const bool is_file = directory.extension() == ".toml";
  const fs::path folder = is_file || directory.has_filename() ? directory : directory.parent_path();
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

std::string unit_on_page(Dimension d) {
  if (d == dimension::none) return "1";
  std::string text = Units{.si = true}.unit_text(d);
  for (const auto& [digit, power] : {std::pair("2", "²"), std::pair("3", "³")})
    if (const auto at = text.find(digit); at != text.npos) text.replace(at, 1, power);
  return text;
}

std::vector<KeySection> case_keys() {
  std::vector<KeySection> all = {section_of("", top_keys)};
  for (const auto sections :
       {domain_sections, fluid_sections, heat_sections, coarsening_sections, contact_sections, wall_sections,
        shape_sections, body_sections, spring_sections, output_sections, quantity_sections})
    for (KeySection& section : sections()) all.push_back(std::move(section));
  return all;
}

void find_idle_sections(const Case&, Diagnostics& findings) {
  look_for_idle_keys(findings, "", top_keys);
}

namespace {

/// Returns the index of a name in a list; if it is missing, reports "unknown <what> '<name>'; did you mean
/// ..." and returns -1.
int index_of(TableReader& reader, std::string_view key, const std::string& name,
             const std::vector<std::string>& names, std::string_view what) {
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return static_cast<int>(found - names.begin());
  reader.fail(key, "{}: unknown {} '{}'{}", reader.path(key), what, name, suggestion(name, names));
  return -1;
}

}  // namespace

std::vector<int> read_names(TableReader& reader, const char* key, const std::vector<std::string>& known,
                            std::string_view what) {
  std::vector<int> indices;
  const Node* list = reader.find(key);
  if (!list) return indices;
  const auto names = list->strings();
  if (!names) reader.refuse(key, "a list of names out of " + joined(known));
  for (const std::string& name : names.value_or(std::vector<std::string>{}))
    if (const int i = index_of(reader, key, name, known, what); i >= 0) indices.push_back(i);
  return indices;
}

std::optional<int> read_name(TableReader& reader, const char* key, const std::vector<std::string>& names,
                             std::string_view what) {
  const auto name = reader.string(key);
  const int index = name ? index_of(reader, key, *name, names, what) : -1;
  return index >= 0 ? std::optional(index) : std::nullopt;
}

std::string read_new_name(TableReader& reader, std::vector<std::string>& names, std::string_view what,
                          const std::string& fallback) {
  const std::string name = reader.string("name").value_or(fallback);
  if (!name.empty() && std::ranges::count(names, name))
    reader.fail("name", "{}: there already is a {} '{}'", reader.path("name"), what, name);
  return names.emplace_back(name);
}

Case read_case(CaseSource& source, const std::vector<std::string>& overrides) {
  const Node root = tree_of_case(source.text, source.file, overrides);
  Case setup;
  setup.overrides = overrides;
  setup.directory = source.directory();

  ReadContext context;
  context.file = source.file;
  context.source = &source;
  read_sections({context, &root, "", Place{source.file}}, setup);
  context.report_unread(root, "");
  if (!context.errors.empty()) throw CaseError(std::move(context.errors));
  setup.warnings = std::move(context.warnings);
  setup.places = std::move(context.places);
  setup.files = std::move(context.files);
  setup.text = source.text;
  for (const std::string& file_read : setup.files) setup.text += fmt::format("\n# file {}", file_read);
  for (const std::string& argument : overrides) setup.text += "\n# " + override_text(argument);
  return setup;
}

Case read_case(const fs::path& directory, const std::vector<std::string>& overrides) {
  CaseSource source = read_source(directory);
  return read_case(source, overrides);
}

}  // namespace silt
