#include <algorithm>
#include <cstddef>
#include <numeric>
#include <optional>

#include "adapters/hdf5/checkpoint_parts.hpp"
#include "adapters/hdf5/slice_exchange.hpp"
#include "adapters/hdf5/table.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::adapters::hdf5 {
namespace {

using Bytes = std::vector<std::byte>;
using Counts = std::vector<std::uint64_t>;  // numbers of impulses, by body

// ---- the columns ----

/// The columns of /bodies: the members of rigid::BodyRecord, then columns of its attached state.
std::vector<Column> record_columns(std::span<const AttachedColumn> holder) {
  using Record = rigid::BodyRecord;
  std::vector<Column> columns;
  rigid::visit_columns([&](const rigid::BodyColumn& c, auto, auto member) {
    columns.push_back(column_of<Record>(c.name, member));
  });
  for (const AttachedColumn& c : holder)
    columns.push_back({c.name, offset_of<Record>(&Record::attached_state) + c.offset,
                       c.type == AttachedColumn::int64 ? Column::int64 : Column::float64, c.count});
  for (Column& c : columns) c.name = "/bodies/" + c.name;
  return columns;
}

/// The number of impulses of a body, also in /bodies.
const Column count_column{"/bodies/impulse_count", 0, Column::uint64};

/// A stored impulse as a row of /impulses, in the order of the bodies.
struct ImpulseRow {
  rigid::BodyId partner;
  std::int8_t image[3];
  std::uint64_t feature;
  double impulse[3];
};

const std::vector<Column> impulse_columns{column_of<ImpulseRow>("/impulses/partner", &ImpulseRow::partner),
                                          column_of<ImpulseRow>("/impulses/image", &ImpulseRow::image),
                                          column_of<ImpulseRow>("/impulses/feature", &ImpulseRow::feature),
                                          column_of<ImpulseRow>("/impulses/impulse", &ImpulseRow::impulse)};

ImpulseRow row_of(const rigid::StoredImpulse& s) {
  return {
      s.partner, {s.image.x, s.image.y, s.image.z}, s.feature, {s.impulse[0], s.impulse[1], s.impulse[2]}};
}

rigid::StoredImpulse impulse_of(const ImpulseRow& r) {
  return {r.partner,
          {r.image[0], r.image[1], r.image[2]},
          r.feature,
          rigid::Vec3(r.impulse[0], r.impulse[1], r.impulse[2])};
}

Counts as_numbers(const Bytes& bytes) {
  Counts numbers(bytes.size() / sizeof(std::uint64_t));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}
Bytes as_bytes(const Counts& numbers) {
  const auto bytes = std::as_bytes(std::span(numbers));
  return {bytes.begin(), bytes.end()};
}

// ---- writing ----

IdOrder order_of(MPI_Comm comm, const Path& path, const OwnedRows& owned) {
  Counts ids;
  parallel::together(comm, [&] {
    for (std::size_t i = 0; i < owned.n; ++i) ids.push_back(owned.record(i).id);
  });
  IdOrder order = order_by_id(comm, ids);
  if (order.twice) throw Error(path.string() + ": body " + std::to_string(*order.twice) + " has two owners");
  return order;
}

/// The positions of the impulses of this rank's bodies, in the order of all bodies' ids.
struct ImpulseOrder {
  Counts counts;
  std::vector<SliceExchange::Run> places;
  std::uint64_t total = 0;
};

ImpulseOrder impulse_order_of(MPI_Comm comm, const OwnedRows& owned, const IdOrder& order,
                              const SliceExchange& bodies) {
  ImpulseOrder impulses;
  constexpr std::size_t width = sizeof(std::uint64_t);
  Bytes bytes;
  Counts slice;
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
    const Counts first = as_numbers(bytes);
    for (std::size_t k = 0; k < first.size(); ++k)
      if (impulses.counts[k] > 0) impulses.places.push_back({first[k], impulses.counts[k]});
  });
  return impulses;
}

/// Writes columns by slices and sums their checksums.
class ColumnWriter {
 public:
  /// places: where the columns' values begin, in the order of writing.
  ColumnWriter(MPI_Comm comm, const Path& path, Counts places) : comm_(comm), places_(std::move(places)) {
    parallel::together(comm_, [&] { file_.emplace(path, RawFile::to_write); });
  }
  /// make(values) appends this rank's values.
  template <class Make>
  void write(const Column& c, const SliceExchange& slices, Make&& make) {
    Bytes values;
    parallel::together(comm_, [&] { make(values); });
    const Bytes slice = slices.to_slice(c.bytes(), std::move(values));
    parallel::together(comm_, [&] {
      file_->write(places_[names_.size()] + slices.slice_begin() * c.bytes(), slice);
      names_.push_back(c.name);
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
  std::optional<RawFile> file_;
  Counts places_, sums_;
  std::vector<std::string> names_;
};

}  // namespace

std::map<std::string, std::uint64_t> write_body_tables(MPI_Comm comm, const Path& path,
                                                       const std::function<File(std::uint64_t bytes)>& open,
                                                       const OwnedRows& owned,
                                                       std::span<const AttachedColumn> holder) {
  const IdOrder order = order_of(comm, path, owned);
  const SliceExchange bodies(comm, order.total, order.places);
  const ImpulseOrder impulse_order = impulse_order_of(comm, owned, order, bodies);
  const SliceExchange impulses(comm, impulse_order.total, impulse_order.places);
  std::vector<Column> columns;
  Counts places;
  parallel::together(comm, [&] {
    columns = record_columns(holder);
    places.resize(columns.size() + 1 + impulse_columns.size());
  });
  parallel::on_rank_0(comm, [&] {
    std::uint64_t of_body = count_column.bytes(), of_impulse = 0;
    for (const Column& c : columns) of_body += c.bytes();
    for (const Column& c : impulse_columns) of_impulse += c.bytes();
    File file = open(of_body * order.total + of_impulse * impulse_order.total);
    auto place = places.begin();
    const auto create = [&](const Column& c, std::uint64_t rows) {
      *place++ = file.place_of(file.create_dataset(c.name, c.stored_type(), table_shape(rows, c.components)));
    };
    file.create_group("/bodies");
    for (const Column& c : columns) create(c, order.total);
    create(count_column, order.total);
    file.create_group("/impulses");
    for (const Column& c : impulse_columns) create(c, impulse_order.total);
    file.close();
  });
  parallel::broadcast(comm, std::span(places));
  ColumnWriter writer(comm, path, std::move(places));
  for (const Column& c : columns)
    writer.write(c, bodies, [&](Bytes& values) {
      gather_column<rigid::BodyRecord>(
          c, owned.n, [&](std::size_t k) { return owned.record(order.rows[k]); }, values);
    });
  writer.write(count_column, bodies, [&](Bytes& values) { values = as_bytes(impulse_order.counts); });
  for (const Column& c : impulse_columns)
    writer.write(c, impulses, [&](Bytes& values) {
      for (const std::size_t i : order.rows) {
        const auto& list = owned.impulses(i);
        gather_column<ImpulseRow>(
            c, list.size(), [&](std::size_t k) { return row_of(list[k]); }, values);
      }
    });
  return writer.close();
}

// ---- reading ----

namespace {

struct TableReader {
  const File& file;
  const RawFile raw;

  explicit TableReader(const File& f) : file(f), raw(f.path(), RawFile::to_read) {}
  std::uint64_t rows_in(const std::string& dataset) const { return file.place(dataset).shape[0]; }
  /// Reads rows [first, first + n) of a column that must have `rows` rows.
  Bytes read(const Column& c, std::uint64_t rows, std::uint64_t first, std::uint64_t n) const {
    const Place place = file.place(c.name, c.stored_type(), table_shape(rows, c.components));
    return raw.read(place.at + first * c.bytes(), n * c.bytes());
  }
};

/// Reads the impulses of bodies with these counts, from row `first` of `total` on.
std::vector<std::vector<rigid::StoredImpulse>> read_impulses(const TableReader& reader, const Counts& counts,
                                                             std::uint64_t total, std::uint64_t first) {
  std::vector<ImpulseRow> rows(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
  for (const Column& c : impulse_columns) scatter_column(c, reader.read(c, total, first, rows.size()), rows);
  std::vector<std::vector<rigid::StoredImpulse>> lists(counts.size());
  auto row = rows.begin();
  for (std::size_t i = 0; i < counts.size(); row += counts[i++])
    std::transform(row, row + counts[i], std::back_inserter(lists[i]), impulse_of);
  return lists;
}

/// Refuses records whose ids do not ascend, `last` being the id before them.
void require_rising_ids(const File& file, const std::vector<rigid::BodyRecord>& records, std::uint64_t last) {
  for (const rigid::BodyRecord& r : records) {
    if (r.id <= last)
      file.refuse("body " + std::to_string(r.id) + " comes after body " + std::to_string(last) +
                  "; ids must rise, each once");
    last = r.id;
  }
}

}  // namespace

CheckpointReader::Bodies read_body_tables(MPI_Comm comm, const File& file,
                                          std::span<const AttachedColumn> holder) {
  CheckpointReader::Bodies found;
  const int rank = parallel::rank_of(comm), ranks = parallel::ranks_of(comm);
  std::optional<TableReader> reader;
  Counts counts;
  std::uint64_t all = 0, impulses = 0;
  const auto do_not_fit = [&] {
    file.refuse("bodies and impulses do not fit together: the sum of " + count_column.name +
                " is not the length of " + impulse_columns[0].name);
  };
  parallel::together(comm, [&] {
    reader.emplace(file);
    const std::uint64_t total = reader->rows_in(count_column.name);
    const std::uint64_t first = total * rank / ranks, n = total * (rank + 1) / ranks - first;
    all = reader->rows_in(impulse_columns[0].name);
    found.first_body = first;
    found.records.resize(n);
    const std::vector<Column> columns = record_columns(holder);
    if (reader->rows_in(columns[0].name) != total)
      file.refuse(columns[0].name + " has another shape than " + count_column.name);
    for (const Column& c : columns) scatter_column(c, reader->read(c, total, first, n), found.records);
    const Column& id = columns[0];
    require_rising_ids(file, found.records,
                       first == 0 ? 0 : as_numbers(reader->read(id, total, first - 1, 1))[0]);
    counts = as_numbers(reader->read(count_column, total, first, n));
    for (const std::uint64_t count : counts) {
      if (count > all - impulses) do_not_fit();
      impulses += count;
    }
  });
  found.first_impulse = parallel::sum_of_ranks_before(comm, impulses);
  const std::uint64_t of_ranks = parallel::sum_over_ranks(comm, impulses);
  parallel::together(comm, [&] {
    if (of_ranks != all) do_not_fit();
    found.impulses = read_impulses(*reader, counts, all, found.first_impulse);
  });
  return found;
}

}  // namespace silt::adapters::hdf5
