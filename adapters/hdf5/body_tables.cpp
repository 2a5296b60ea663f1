#include "adapters/hdf5/body_tables.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <optional>

#include "adapters/hdf5/checksum.hpp"
#include "adapters/hdf5/order_by_id.hpp"
#include "adapters/hdf5/shared_file.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::adapters::hdf5 {

std::vector<Column> record_columns(std::span<const rigid::HolderColumn> holder) {
  using R = rigid::BodyRecord;
  const R record;
  const auto offset = [&](const auto& member) {
    return std::size_t(reinterpret_cast<const char*>(&member) - reinterpret_cast<const char*>(&record));
  };
  const std::size_t rest = offset(record.rest);
  std::vector<Column> columns{
      {"id", offset(record.id), Column::uint64},
      {"shape", offset(record.shape), Column::int32},
      {"material", offset(record.material), Column::int32},
      {"kind", offset(record.kind), Column::int32},
      {"motion", offset(record.motion), Column::uint8},
      {"wakefulness", offset(record.wakefulness), Column::uint8},
      {"mass", offset(record.mass), Column::float64},
      {"weight_in_fluid", offset(record.weight_in_fluid), Column::float64},
      {"inertia_B", offset(record.inertia_B), Column::float64, 9},
      {"position", offset(record.position), Column::float64, 3},
      {"orientation", offset(record.orientation), Column::float64, 4},
      {"image", offset(record.image), Column::int32, 3},
      {"velocity", offset(record.velocity), Column::float64, 3},
      {"angular_velocity", offset(record.angular_velocity), Column::float64, 3},
      {"angular_momentum", offset(record.angular_momentum), Column::float64, 3},
      {"quiet_steps", rest + offsetof(rigid::Rest, quiet_steps), Column::int32},
      {"rest_impulse", rest + offsetof(rigid::Rest, impulse), Column::float64, 3},
      {"rest_angular_impulse", rest + offsetof(rigid::Rest, angular_impulse), Column::float64, 3},
      {"rest_unbalanced_velocity", rest + offsetof(rigid::Rest, unbalanced_velocity), Column::float64, 3},
      {"rest_unbalanced_angular_velocity", rest + offsetof(rigid::Rest, unbalanced_angular_velocity),
       Column::float64, 3}};
  for (const rigid::HolderColumn& c : holder) {
    const bool whole = c.type == rigid::HolderColumn::int64;
    const std::size_t first =
        whole ? offsetof(rigid::HolderState, integers) : offsetof(rigid::HolderState, numbers);
    columns.push_back({c.name, offset(record.holder_state) + first + 8 * std::size_t(c.first),
                       whole ? Column::int64 : Column::float64, c.count});
  }
  return columns;
}

const std::vector<Column>& impulse_columns() {
  static const std::vector<Column> columns{{"partner", offsetof(ImpulseRow, partner), Column::uint64},
                                           {"image", offsetof(ImpulseRow, image), Column::int8, 3},
                                           {"held", offsetof(ImpulseRow, held), Column::int8},
                                           {"feature", offsetof(ImpulseRow, feature), Column::uint64},
                                           {"impulse", offsetof(ImpulseRow, impulse), Column::float64, 3}};
  return columns;
}

const Column& impulse_count_column() {
  static const Column column{"impulse_count", 0, Column::uint64};
  return column;
}

namespace {

const std::string bodies_group = "/bodies", impulses_group = "/impulses";

IdOrder order_of(MPI_Comm comm, const Path& path, const OwnedRows& owned) {
  std::vector<std::uint64_t> ids;
  parallel::together(comm, [&] {
    for (std::size_t i = 0; i < owned.n; ++i) ids.push_back(owned.record(i).id);
  });
  IdOrder order = order_by_id(comm, ids);
  if (order.twice) throw Error(path.string() + ": body " + std::to_string(*order.twice) + " has two owners");
  return order;
}

std::vector<std::uint64_t> as_numbers(const std::vector<std::byte>& bytes) {
  std::vector<std::uint64_t> numbers(bytes.size() / sizeof(std::uint64_t));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}
std::vector<std::byte> as_bytes(const std::vector<std::uint64_t>& numbers) {
  const auto bytes = std::as_bytes(std::span(numbers));
  return {bytes.begin(), bytes.end()};
}

/// Where the impulses of this rank's bodies go: before each body's come those of all smaller ids.
struct ImpulseOrder {
  std::vector<std::uint64_t> counts;
  std::vector<SliceExchange::Run> places;
  std::uint64_t total = 0;
};

ImpulseOrder impulse_order_of(MPI_Comm comm, const OwnedRows& owned, const IdOrder& order,
                              const SliceExchange& bodies) {
  ImpulseOrder impulses;
  constexpr std::size_t width = sizeof(std::uint64_t);
  std::vector<std::byte> bytes;
  std::vector<std::uint64_t> slice;
  parallel::together(comm, [&] {
    for (const std::size_t i : order.rows) impulses.counts.push_back(owned.impulses(i).size());
    bytes = as_bytes(impulses.counts);
  });
  bytes = bodies.to_slice(width, std::move(bytes));
  parallel::together(comm, [&] { slice = as_numbers(bytes); });
  const std::uint64_t mine = std::accumulate(slice.begin(), slice.end(), std::uint64_t{0});
  impulses.total = parallel::sum_over_ranks(comm, mine);
  std::exclusive_scan(slice.begin(), slice.end(), slice.begin(), parallel::sum_of_ranks_before(comm, mine));
  parallel::together(comm, [&] { bytes = as_bytes(slice); });
  bytes = bodies.from_slice(width, bytes);
  parallel::together(comm, [&] {
    const auto first = as_numbers(bytes);
    for (std::size_t k = 0; k < first.size(); ++k)
      if (impulses.counts[k] > 0) impulses.places.push_back({first[k], impulses.counts[k]});
  });
  return impulses;
}

ImpulseRow row_of(const rigid::StoredImpulse& s) {
  ImpulseRow r{};
  r.partner = s.partner;
  r.image[0] = s.image.x, r.image[1] = s.image.y, r.image[2] = s.image.z;
  r.held = s.held;
  r.feature = s.feature;
  for (int d = 0; d < 3; ++d) r.impulse[d] = s.impulse[d];
  return r;
}

std::vector<std::byte> gather_impulses(const Column& c, const OwnedRows& owned, const IdOrder& order) {
  std::vector<std::byte> packed;
  for (const std::size_t i : order.rows) {
    const auto& list = owned.impulses(i);
    const auto more =
        gather_column<ImpulseRow>(c, list.size(), [&](std::size_t k) { return row_of(list[k]); });
    packed.insert(packed.end(), more.begin(), more.end());
  }
  return packed;
}

std::uint64_t bytes_of(const std::vector<Column>& columns, std::uint64_t rows) {
  std::uint64_t bytes = 0;
  for (const Column& c : columns) bytes += c.bytes() * rows;
  return bytes;
}

/// Creates the tables of so many bodies and impulses, and returns where in the file the values of each column
/// begin.
std::vector<std::uint64_t> create_tables(File& file, const std::vector<Column>& bodies, std::uint64_t n,
                                         std::uint64_t impulses) {
  std::vector<std::uint64_t> places;
  const auto create = [&](const std::string& group, const Column& c, std::uint64_t rows) {
    std::vector<hsize_t> shape{rows};
    if (c.components > 1) shape.push_back(c.components);
    places.push_back(file.place_of(file.create_contiguous(group + '/' + c.name, c.memory_type(), shape)));
  };
  file.group(bodies_group, true);
  for (const Column& c : bodies) create(bodies_group, c, n);
  file.group(impulses_group, true);
  for (const Column& c : impulse_columns()) create(impulses_group, c, impulses);
  return places;
}

/// Writes columns slice by slice, in the order in which they were created, and adds up their checksums.
class ColumnWriter {
 public:
  ColumnWriter(MPI_Comm comm, const Path& path, std::vector<std::uint64_t> places)
      : comm_(comm), places_(std::move(places)) {
    parallel::together(comm_, [&] { file_.emplace(path); });
  }
  /// make() gives this rank's values.
  template <class Make>
  void write(const std::string& group, const Column& c, const SliceExchange& slices, Make&& make) {
    std::vector<std::byte> values;
    parallel::together(comm_, [&] { values = make(); });
    const auto slice = slices.to_slice(c.bytes(), std::move(values));
    parallel::together(comm_, [&] {
      file_->write(places_[names_.size()] + slices.slice_begin() * c.bytes(), slice);
      names_.push_back(group + '/' + c.name);
      sums_.push_back(run_checksum(c.value_bytes(), slice.data(), slices.slice_size() * c.components,
                                   slices.slice_begin() * c.components));
    });
  }
  std::map<std::string, std::uint64_t> close() {
    parallel::together(comm_, [&] { file_->close(); });
    parallel::sum_over_ranks(comm_, std::span(sums_));
    std::map<std::string, std::uint64_t> checksums;
    for (std::size_t k = 0; k < sums_.size(); ++k) checksums[names_[k]] = sums_[k];
    return checksums;
  }

 private:
  MPI_Comm comm_;
  std::optional<SharedFile> file_;
  std::vector<std::uint64_t> places_;
  std::vector<std::string> names_;
  std::vector<std::uint64_t> sums_;
};

}  // namespace

std::map<std::string, std::uint64_t> write_body_tables(MPI_Comm comm, const Path& path,
                                                       const std::function<File(std::uint64_t bytes)>& open,
                                                       const OwnedRows& owned,
                                                       std::span<const rigid::HolderColumn> holder) {
  const IdOrder order = order_of(comm, path, owned);
  const SliceExchange bodies(comm, order.total, order.places);
  const ImpulseOrder impulse_order = impulse_order_of(comm, owned, order, bodies);
  const SliceExchange impulses(comm, impulse_order.total, impulse_order.places);
  std::vector<Column> columns;
  std::vector<std::uint64_t> places;
  parallel::together(comm, [&] {
    columns = record_columns(holder);
    places.resize(columns.size() + 1 + impulse_columns().size());
  });
  parallel::on_rank_0(comm, [&] {
    std::vector<Column> of_bodies = columns;
    of_bodies.push_back(impulse_count_column());
    File file = open(bytes_of(of_bodies, order.total) + bytes_of(impulse_columns(), impulse_order.total));
    places = create_tables(file, of_bodies, order.total, impulse_order.total);
    file.close();
  });
  parallel::broadcast(comm, std::span(places));
  ColumnWriter writer(comm, path, std::move(places));
  for (const Column& c : columns)
    writer.write(bodies_group, c, bodies, [&] {
      return gather_column<rigid::BodyRecord>(c, owned.n,
                                              [&](std::size_t k) { return owned.record(order.rows[k]); });
    });
  writer.write(bodies_group, impulse_count_column(), bodies, [&] { return as_bytes(impulse_order.counts); });
  for (const Column& c : impulse_columns())
    writer.write(impulses_group, c, impulses, [&] { return gather_impulses(c, owned, order); });
  return writer.close();
}

namespace {

/// Calls take(column, values) for the rows [first, first + n) of each column.
template <class Take>
void read_columns(const File& file, const std::string& group, const std::vector<Column>& columns,
                  std::uint64_t rows, std::uint64_t first, std::uint64_t n, Take&& take) {
  for (const Column& c : columns) {
    const Handle dataset = file.dataset(group + '/' + c.name);
    std::vector<hsize_t> shape{rows};
    if (c.components > 1) shape.push_back(c.components);
    if (file.shape(dataset) != shape)
      throw Error(file.path().string() + ": " + group + '/' + c.name +
                  " has another shape than this version writes");
    take(c, read_rows(file, dataset, c, first, n));
  }
}

std::uint64_t rows_in(const File& file, const std::string& group, const Column& c) {
  const auto shape = file.shape(file.dataset(group + '/' + c.name));
  if (shape.size() != (c.components > 1 ? 2 : 1))
    throw Error(file.path().string() + ": " + group + '/' + c.name +
                " has another shape than this version writes");
  return shape[0];
}

/// The impulses of bodies that have so many, from row `first` on.
std::vector<std::vector<rigid::StoredImpulse>> read_impulses(const File& file,
                                                             const std::vector<std::uint64_t>& counts,
                                                             std::uint64_t first, std::uint64_t n) {
  std::vector<ImpulseRow> rows(n);
  const auto& columns = impulse_columns();
  read_columns(file, impulses_group, columns, rows_in(file, impulses_group, columns[0]), first, n,
               [&](const Column& c, const auto& values) {
                 scatter_column(c, values, rows.data(), sizeof(ImpulseRow));
               });
  std::vector<std::vector<rigid::StoredImpulse>> lists(counts.size());
  const ImpulseRow* r = rows.data();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    lists[i].reserve(counts[i]);
    for (std::uint64_t k = 0; k < counts[i]; ++k, ++r)
      lists[i].push_back({r->partner,
                          {r->image[0], r->image[1], r->image[2]},
                          r->feature,
                          rigid::Vec3(r->impulse[0], r->impulse[1], r->impulse[2]),
                          r->held != 0});
  }
  return lists;
}

/// Of a slice of the bodies that begins at row `first`.
void require_rising_ids(const File& file, const std::vector<rigid::BodyRecord>& records,
                        std::uint64_t first) {
  std::uint64_t last = 0;
  if (first > 0 && !records.empty()) {
    const Column id = record_columns({})[0];
    last = as_numbers(read_rows(file, file.dataset(bodies_group + '/' + id.name), id, first - 1, 1))[0];
  }
  for (const rigid::BodyRecord& r : records) {
    if (r.id <= last)
      throw Error(file.path().string() + ": body " + std::to_string(r.id) + " comes after body " +
                  std::to_string(last) + "; ids must rise, each once");
    last = r.id;
  }
}

/// The sum of the bodies' numbers of impulses; no part of it may be more than there are.
std::uint64_t sum_of_counts(const std::vector<std::uint64_t>& counts, std::uint64_t there, const Path& path) {
  std::uint64_t sum = 0;
  for (const std::uint64_t n : counts) {
    if (n > there - sum) throw Error(path.string() + ": bodies and impulses do not fit together");
    sum += n;
  }
  return sum;
}

}  // namespace

CheckpointReader::Bodies read_body_tables(MPI_Comm comm, const File& file,
                                          std::span<const rigid::HolderColumn> holder) {
  CheckpointReader::Bodies found;
  const int rank = parallel::rank_of(comm), ranks = parallel::ranks_of(comm);
  std::vector<std::uint64_t> counts;
  std::uint64_t n = 0, impulses = 0;
  parallel::together(comm, [&] {
    const std::uint64_t total = rows_in(file, bodies_group, impulse_count_column());
    found.first_body = total * rank / ranks;
    n = total * (rank + 1) / ranks - found.first_body;
    found.records.resize(n);
    read_columns(file, bodies_group, record_columns(holder), total, found.first_body, n,
                 [&](const Column& c, const auto& values) {
                   scatter_column(c, values, found.records.data(), sizeof(rigid::BodyRecord));
                 });
    read_columns(file, bodies_group, {impulse_count_column()}, total, found.first_body, n,
                 [&](const Column&, const auto& values) { counts = as_numbers(values); });
    require_rising_ids(file, found.records, found.first_body);
    impulses = sum_of_counts(counts, rows_in(file, impulses_group, impulse_columns()[0]), file.path());
  });
  found.first_impulse = parallel::sum_of_ranks_before(comm, impulses);
  const std::uint64_t all = parallel::sum_over_ranks(comm, impulses);
  parallel::together(comm, [&] {
    if (all != rows_in(file, impulses_group, impulse_columns()[0]))
      throw Error(file.path().string() + ": bodies and impulses do not fit together");
    found.impulses = read_impulses(file, counts, found.first_impulse, impulses);
  });
  return found;
}

}  // namespace silt::adapters::hdf5
