#pragma once
// Prefetching of cache lines. The empty asm statement keeps GCC from removing calls without an effect.
#include <cstddef>

namespace silt {

[[gnu::always_inline]] inline void prefetch_to_read(const void* line) {
  __builtin_prefetch(line, 0);
  asm volatile("");
}
[[gnu::always_inline]] inline void prefetch_to_write(const void* line) {
  __builtin_prefetch(line, 1);
  asm volatile("");
}

template <class List, class Visit>
[[gnu::always_inline]] inline void fetch_and_visit(const List&, std::size_t k, Visit& visit) {
  visit(k);
}
template <class List, class Fetch, class... More>
[[gnu::always_inline]] inline void fetch_and_visit(const List& list, std::size_t k, std::size_t distance,
                                                   Fetch& fetch, More&... more) {
  if (k + distance < list.size()) fetch(list[k + distance]);
  fetch_and_visit(list, k, more...);
}

/// Calls visit(k) for the entries [begin, end) of a list, and before each call fetch(entry) for the entry
/// `distance` ahead, which may be beyond `end`, so that its data is in the cache when it is visited. Several
/// pairs of distance and fetch may be given.
template <class List, class... FetchesAndVisit>
[[gnu::always_inline]] inline void for_ahead_in(const List& list, std::size_t begin, std::size_t end,
                                                FetchesAndVisit&&... distance_fetch_visit) {
  for (std::size_t k = begin; k < end; ++k) fetch_and_visit(list, k, distance_fetch_visit...);
}
/// The same for the whole list.
template <class List, class... FetchesAndVisit>
[[gnu::always_inline]] inline void for_ahead(const List& list, FetchesAndVisit&&... distance_fetch_visit) {
  for_ahead_in(list, 0, list.size(), distance_fetch_visit...);
}

}  // namespace silt
