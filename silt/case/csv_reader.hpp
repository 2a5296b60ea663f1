#pragma once
// A CSV file of numbers beside a case: lines of numbers with commas between them, below lines of headings.
#include <cstdint>
#include <istream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace silt {

/// Returns a text without the blanks around it.
std::string_view trimmed(std::string_view);

/// Reads a file line by line. Lines end in LF, CRLF or CR; blank ones and those that begin with # do not
/// count. A byte order mark of UTF-8 at the beginning is passed over; fields may stand in double quotes (RFC
/// 4180).
class CsvReader {
 public:
  /// Passes the lines of headings, which come first: no field of theirs is, or looks like, a number.
  explicit CsvReader(std::istream&);
  /// Returns the fields of each line of headings.
  const std::vector<std::vector<std::string>>& headings() const { return headings_; }

  /// Reads on only the lines that begin in part `part` of `parts` of the bytes below the headings.
  void take_part(int part, int parts);
  /// Goes on to the next line that counts; false after the last one.
  bool next();
  /// Returns how many lines have been passed, those that do not count and the headings included; of a part
  /// that is not the first, those of that part.
  std::uint64_t lines() const { return lines_; }
  /// Reads the numbers of the line. std::invalid_argument: `is "4;5;6": it has semicolons between its
  /// numbers; it must be ` and what the line must be.
  void numbers(std::span<double>, std::string_view must) const;

 private:
  bool take_line();
  void go_to(std::uint64_t byte);

  std::istream* stream_;
  std::string line_;
  std::uint64_t at_ = 0, end_ = ~std::uint64_t{0};  // of the bytes: where the next line begins, the part ends
  std::uint64_t lines_ = 0;
  std::vector<std::vector<std::string>> headings_;
};

}  // namespace silt
