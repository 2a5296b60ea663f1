#include "adapters/stl/foreign_format.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <string>

namespace silt::adapters {

namespace {

struct Foreign {
  std::string_view start;  // in lower case
  const char* what;
};

using namespace std::string_view_literals;

constexpr Foreign formats[] = {
    {"<!doctype"sv, "it is a page of the web (HTML), not a surface: download the file itself"},
    {"<html"sv, "it is a page of the web (HTML), not a surface: download the file itself"},
    {"<?xml"sv, "it is XML (as of 3MF, AMF or COLLADA): save the surface as STL, OBJ or PLY"},
    {"version https://git-lfs"sv,
     "it is a pointer of Git LFS, not the file itself: run 'git lfs pull' where it comes from"},
    {"iso-10303"sv, "it is STEP, which has no triangles: save it as STL, OBJ or PLY"},
    {"\x1f\x8b"sv, "it is compressed (gzip): unpack it"},
    {"pk\x03\x04"sv, "it is a zip archive (as 3MF is): unpack it, and save the surface as STL, OBJ or PLY"},
    {"\xff\xfe"sv, "it is text in UTF-16: save it as UTF-8 or ASCII"},
    {"\xfe\xff"sv, "it is text in UTF-16: save it as UTF-8 or ASCII"}};

}  // namespace

std::string_view without_mark(std::string_view bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  return bytes;
}

void refuse_foreign(std::string_view bytes) {
  constexpr std::size_t longest = 100;
  if (bytes.empty()) throw std::invalid_argument("it is empty");
  std::string start(without_mark(bytes).substr(0, longest));
  start.erase(0, std::min(start.find_first_not_of(" \t\r\n"), start.size()));
  for (char& c : start) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const Foreign& format : formats)
    if (start.starts_with(format.start)) throw std::invalid_argument(format.what);
}

}  // namespace silt::adapters
