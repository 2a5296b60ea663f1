#include "coupler/case/csv_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "coupler/case/csv_fields.hpp"

namespace silt::coupler {
namespace {

bool counts(std::string_view line) {
  const std::string_view text = trimmed(line);
  return !text.empty() && text[0] != '#';
}

/// Reads numbers that stand as they are, without quotes.
bool take_numbers(std::string_view text, std::span<double> numbers) {
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    text = trimmed(text);
    if (!take_number(text, numbers[k])) return false;
    text = trimmed(text);
    if (k + 1 == numbers.size()) return text.empty();
    if (text.empty() || text[0] != ',') return false;
    text.remove_prefix(1);
  }
  return false;
}

bool take_numbers_of_fields(std::string_view line, std::span<double> numbers) {
  const auto fields = csv_fields(line);
  if (!fields || fields->size() != numbers.size()) return false;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    std::string_view field = trimmed((*fields)[k]);
    if (!take_number(field, numbers[k]) || !field.empty()) return false;
  }
  return true;
}

/// Returns the beginning of a line with what a terminal cannot show as question marks.
std::string shown_line(std::string_view line) {
  line = trimmed(line);
  std::size_t end = std::min<std::size_t>(60, line.size());
  while (end < line.size() && (line[end] & 0xC0) == 0x80) --end;  // no part of a character
  std::string text(line.substr(0, end));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7F' || c == '\xFE' || c == '\xFF') c = '?';
  return text;
}

}  // namespace

CsvReader::CsvReader(std::istream& stream) : stream_(&stream) {
  for (const char expected : byte_order_mark) {
    if (stream.rdbuf()->sgetc() != std::char_traits<char>::to_int_type(expected)) break;
    stream.rdbuf()->sbumpc();
    ++at_;
  }
  if (at_ != byte_order_mark.size()) at_ = 0;
  stream.rdbuf()->pubseekpos(static_cast<std::streamoff>(at_), std::ios::in);
  for (std::uint64_t begin = at_; take_line(); begin = at_, ++lines_) {
    if (!counts(line_)) continue;
    if (auto fields = csv_headings(line_)) {
      headings_.push_back(std::move(*fields));
      continue;
    }
    at_ = begin;
    stream.rdbuf()->pubseekpos(static_cast<std::streamoff>(at_), std::ios::in);
    break;
  }
}

bool CsvReader::take_line() {
  using Traits = std::char_traits<char>;
  std::streambuf& bytes = *stream_->rdbuf();
  line_.clear();
  if (bytes.sgetc() == Traits::eof()) return false;
  for (int c = bytes.sbumpc(); c != Traits::eof(); c = bytes.sbumpc()) {
    ++at_;
    if (c == '\r' && bytes.sgetc() == '\n') continue;
    if (c == '\r' || c == '\n') break;
    line_ += Traits::to_char_type(c);
  }
  return true;
}

void CsvReader::take_part(int part, int parts) {
  std::streambuf& bytes = *stream_->rdbuf();
  const std::uint64_t head = at_;
  const auto size = static_cast<std::uint64_t>(bytes.pubseekoff(0, std::ios::end, std::ios::in)) - head;
  at_ = head + size * part / parts;
  end_ = head + size * (part + 1) / parts;
  if (part > 0) lines_ = 0;
  const bool skips = part > 0 && at_ > 0;  // the end of a line of the part before
  if (skips) --at_;
  bytes.pubseekpos(static_cast<std::streamoff>(at_), std::ios::in);
  if (skips) take_line();
}

bool CsvReader::next() {
  while (at_ < end_ && take_line()) {
    ++lines_;
    if (counts(line_)) return true;
  }
  return false;
}

void CsvReader::numbers(std::span<double> numbers, std::string_view must) const {
  if (take_numbers(line_, numbers) || take_numbers_of_fields(line_, numbers)) return;
  throw std::invalid_argument(fmt::format("is \"{}\": it {}; it must be {}", shown_line(line_),
                                          csv_complaint(line_, numbers.size()), must));
}

}  // namespace silt::coupler
