#pragma once
// Reads a CSV file of numbers: comma-separated lines below heading lines.
#include <cstdint>
#include <istream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace silt {

/// Returns a text without blanks around it.
std::string_view trimmed(std::string_view);

/// Reads a file line by line. Lines end in LF, CRLF or CR; blank lines and those that begin with # are
/// skipped, as is a UTF-8 byte order mark. Fields may be in double quotes (RFC 4180).
class CsvReader {
 public:
  /// Skips heading lines at the start: those without a field that is, or looks like, a number.
  explicit CsvReader(std::istream&);
  /// Returns the fields of each heading line.
  const std::vector<std::vector<std::string>>& headings() const { return headings_; }

  /// Restricts reading to lines that begin in part `part` of `parts` of the bytes below the headings.
  void take_part(int part, int parts);
  /// Goes to the next line with numbers; returns false after the last.
  bool next();
  /// Returns the number of lines read, with skipped ones and headings; of this part unless it is the first.
  std::uint64_t lines() const { return lines_; }
  /// Reads the numbers of the line. Throws std::invalid_argument with `is "4;5;6": it has semicolons between
  /// its numbers; it must be ` and then `must`.
  void numbers(std::span<double>, std::string_view must) const;

 private:
  bool take_line();
  void go_to(std::uint64_t byte);

  std::istream* stream_;
  std::string line_;
  std::uint64_t at_ = 0, end_ = ~std::uint64_t{0};  // bytes: start of the next line, end of the part
  std::uint64_t lines_ = 0;
  std::vector<std::vector<std::string>> headings_;
};

}  // namespace silt
