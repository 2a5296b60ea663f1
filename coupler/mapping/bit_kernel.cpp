// Built once per instruction set.
#include <algorithm>
#include <array>
#include <bit>

#include "coupler/mapping/bit_kernel.hpp"
#include "coupler/mapping/mark_cells.hpp"
#include "lbm/walls/link_places.hpp"

#if defined(SILT_HAS_avx512)
#include <immintrin.h>
#endif

namespace silt::coupler::SILT_BUILD {

namespace {

/// Eight words of a stream from word `first` of a group of planes on: the place of each word's first cell,
/// and a mask of the bits in rows [y0, y1), zero beyond the planes.
struct PlaneWords {
  static constexpr int most = 8;
  std::uint32_t place[most];
  std::uint64_t rows[most] = {};

  PlaneWords(const BitFrame& frame, int first, const FrameRows& wanted) {
    const int count = std::min(most, wanted.planes * frame.plane - first);
    const int words_a_row = std::max(1, frame.pitch / 64), rows_a_word = std::max(1, 64 / frame.pitch);
    const int bits = 64 / rows_a_word;
    int z = first / frame.plane, in_plane = first - z * frame.plane;
    int y = in_plane / words_a_row * rows_a_word, x = in_plane % words_a_row;  // x: word of the row
    for (int w = 0; w < count; ++w) {
      place[w] = lbm::link_place({x * 64, y, z}, 0);
      const int from = std::clamp(wanted.y0 - y, 0, rows_a_word),
                to = std::clamp(wanted.y1 - y, 0, rows_a_word);
      rows[w] = from < to ? ~std::uint64_t{0} >> (64 - (to - from) * bits) << (from * bits) : 0;
      if (++x == words_a_row) x = 0, y += rows_a_word;
      if (++in_plane == frame.plane) in_plane = x = y = 0, ++z;
    }
  }
};

using Words = VectorOf<std::uint64_t, PlaneWords::most>::type;

/// Returns a mask with bit k set if word k has a bit set.
unsigned filled(const Words& w) {
#if defined(SILT_HAS_avx512)
  return _mm512_test_epi64_mask(__m512i(w), __m512i(w));
#else
  using Part = VectorOf<std::uint64_t>::type;
  constexpr int words = int(sizeof(Part) / sizeof(std::uint64_t));
  unsigned f = 0;
  for (int k = 0; k < PlaneWords::most; k += words)
    f |= lane_bits(load<Part>(reinterpret_cast<const std::uint64_t*>(&w) + k) != 0) << k;
  return f;
#endif
}

/// Returns eight words of the stream, shifted so that each bit is that of the cell `shift` bits further on.
Words moved(const std::uint64_t* stream, std::ptrdiff_t shift) {
  const std::uint64_t* const from = stream + (shift >> 6);
  const int s = int(shift & 63);
  return load<Words>(from) >> s | load<Words>(from + 1) << 1 << (63 - s);
}

/// Lists the places of set bits in order; returns their number. May write link_lanes places more.
std::uint32_t list_bits_plain(const BitFrame& frame, const PlaneWords& plane, const Words& words,
                              unsigned filled, std::uint32_t direction, std::uint32_t* out) {
  // writes four without counting the bits: a mispredicted branch costs more
  constexpr int at_once = 4;
  const int log_pitch = std::countr_zero(unsigned(std::min(frame.pitch, 64)));
  const std::uint32_t in_row = (1u << log_pitch) - 1;
  std::uint32_t n = 0;
  for (; filled; filled &= filled - 1) {
    const int w = std::countr_zero(filled);
    const std::uint32_t base = plane.place[w] + direction;
    std::uint64_t bits = words[w];
    const std::uint32_t end = n + std::uint32_t(std::popcount(bits));
    for (; n < end; n += at_once)
#pragma GCC unroll 4
      for (int k = 0; k < at_once; ++k, bits &= bits - 1) {
        const std::uint32_t b = std::uint32_t(std::countr_zero(bits));
        out[n + k] = base + (b & in_row) + (b >> log_pitch << lbm::place_x_bits);
      }
    n = end;
  }
  return n;
}

#if defined(SILT_HAS_avx512)
// Uses operators and full masks, which generate no code: g++ 12 warns of undefined vectors in plain
// intrinsics.
using Eight = VectorOf<std::uint64_t>::type;
using Sixteen = VectorOf<std::uint32_t>::type;

Sixteen first_16_bytes(Eight set) {
  const auto quarter = __builtin_shufflevector(set, set, 0, 1);
  return Sixteen(_mm512_maskz_cvtepu8_epi32(0xFFFF, __m128i(quarter)));
}
Eight without_first_16_bytes(Eight set) {
  return Eight(_mm512_maskz_alignr_epi64(0xFF, __m512i(set), __m512i(set), 2));
}

/// Lists bits 16 at a time: compresses the indices of a word's set bits, then widens them.
__attribute__((target("avx512vbmi2,avx512vbmi,avx512bw"))) std::uint32_t list_bits_compressed(
    const BitFrame& frame, const PlaneWords& plane, const Words& words, unsigned filled,
    std::uint32_t direction, std::uint32_t* out) {
  alignas(64) static constexpr auto ramp = [] {
    std::array<std::uint8_t, 64> r{};
    for (int b = 0; b < 64; ++b) r[b] = std::uint8_t(b);
    return r;
  }();
  const __m512i numbers = _mm512_load_si512(ramp.data());
  const int log_pitch = std::countr_zero(unsigned(std::min(frame.pitch, 64)));
  const std::uint32_t in_row = (1u << log_pitch) - 1;
  std::uint32_t n = 0;
  for (; filled; filled &= filled - 1) {
    const int w = std::countr_zero(filled);
    const std::uint64_t bits = words[w];
    const std::uint32_t base = plane.place[w] + direction;
    Eight set = Eight(_mm512_maskz_compress_epi8(bits, numbers));
    int left = std::popcount(bits);
    for (;;) {
      const Sixteen bit = first_16_bytes(set);
      const Sixteen row = bit >> log_pitch << lbm::place_x_bits;
      const Sixteen places = ((bit & in_row) | row) + base;
      __builtin_memcpy(out + n, &places, sizeof places);
      if (left <= 16) break;
      n += 16, left -= 16;
      set = without_first_16_bytes(set);
    }
    n += std::uint32_t(left);
  }
  return n;
}
#endif

std::uint32_t list_bits(const BitFrame& frame, const PlaneWords& plane, const Words& words, int direction,
                        std::uint32_t* out) {
  const std::uint32_t along = lbm::link_place({}, direction);
#if defined(SILT_HAS_avx512)
  static const bool compresses = __builtin_cpu_supports("avx512vbmi2");
  if (compresses) return list_bits_compressed(frame, plane, words, filled(words), along, out);
#endif
  return list_bits_plain(frame, plane, words, filled(words), along, out);
}

constexpr Team alone{0, 1};

void mark_ball(const BitFrame& frame, const PointInFrame& ball, double radius, std::uint64_t* words) {
  mark_sphere(frame, ball, radius, words, alone);
}

/// Sets the cells inside any part of a surface. Spheres have the cheaper mark_sphere.
void mark_parts(const BitFrame& frame, const PointInFrame& centre, const rigid::SurfaceView<double>& surface,
                std::uint64_t* words) {
  for (int k = 0; k < surface.count; ++k)
    rigid::SILT_BUILD::with_kind(surface.parts[k].kind, [&](auto kind) {
      mark_part<kind()>(frame, centre, surface.parts[k], surface.planes, words, alone);
    });
}

/// Returns the number of bits of a frame's stream that a step along c_i spans.
std::ptrdiff_t step_along(const BitFrame& frame, int i) {
  const lbm::Int3 c = lbm::D3Q19::c[i];
  return c.x + std::ptrdiff_t(frame.pitch) * c.y + std::ptrdiff_t(frame.plane) * 64 * c.z;
}

LinkCounts list_links(const BitFrame& frame, const FrameRows& wanted, const LinkBits& bits,
                      std::uint32_t* place, std::uint32_t* single_cell) {
  LinkCounts n{};
  for (int first = 0; first < wanted.planes * frame.plane; first += PlaneWords::most) {
    const PlaneWords plane(frame, first, wanted);
    const std::size_t at = std::size_t(wanted.z) * frame.plane + first;
    const Words open = load<Words>(bits.open + at) & load<Words>(plane.rows);
    for (int i = 1; i < lbm::D3Q19::directions; ++i) {
      const std::ptrdiff_t step = step_along(frame, i);
      const Words cut = moved(bits.body + at, step) & open;
      if (!filled(cut)) continue;
      Words back{};
      if (bits.reads_behind) back = moved(bits.solid + at, -step) & cut;
      if (filled(back)) n.single_cell += list_bits(frame, plane, back, i, single_cell + n.single_cell);
      n.clear += list_bits(frame, plane, cut & ~back, i, place + n.clear);
    }
  }
  return n;
}

/// Returns 32 cells of each row from words, at indices of 32-bit halves.
using Links = Lanes<float>;
Links::Whole half_words(const std::uint64_t* words, const Links::Whole& at) {
#if defined(SILT_HAS_avx512)
  return Links::Whole(_mm512_mask_i32gather_epi32(__m512i{}, __mmask16(-1), __m512i(at), words, 4));
#else
  Links::Whole found;
  for (int l = 0; l < Links::count; ++l)
    found[l] = std::int32_t(std::uint32_t(words[at[l] >> 1] >> ((at[l] & 1) * 32)));
  return found;
#endif
}

std::uint32_t list_beyond(const std::uint32_t* place, std::uint32_t n, lbm::Int3 corner,
                          const CellBits& solid, std::uint32_t* found) {
  using Whole = Links::Whole;
  constexpr int ghosts = CellBits::ghosts;
  const lbm::Int3 size = solid.size();
  const std::int32_t row = 2 * solid.words(), plane = row * (size.y + 2 * ghosts);
  const std::int32_t first = std::int32_t(2 * solid.row(0, 0));
  std::uint32_t count = 0;
  for (std::uint32_t k = 0; k < n; k += Links::count) {
    const auto at = load<Whole>(place + k);
    const Whole direction = (at >> lbm::place_direction_shift) & 31;
    Whole far[3] = {(at & ((1 << lbm::place_x_bits) - 1)) + corner.x,
                    ((at >> lbm::place_x_bits) & ((1 << lbm::place_y_bits) - 1)) + corner.y,
                    ((at >> lbm::place_z_shift) & ((1 << lbm::place_z_bits) - 1)) + corner.z};
    Whole listed{};
    const Whole packed = Links::look_up(lbm::components<lbm::D3Q19>.packed, direction);
    for (int d = 0; d < 3; ++d) {
      const Whole c = lbm::SILT_BUILD::component(packed, d);
      far[d] -= c;
      listed |= (far[d] < 0) | (far[d] >= size[d]);
      far[d] -= c;
    }
    const Whole bit = far[0] + ghosts;
    const Whole word = half_words(solid.all().data(), first + far[1] * row + far[2] * plane + (bit >> 5));
    listed |= -((word >> (bit & 31)) & 1);
    if (!any_lane(listed)) continue;
    for (std::uint32_t l = 0; l < Links::count && k + l < n; ++l)
      if (listed[l]) found[count++] = k + l;
  }
  return count;
}

void widen(const BitFrame& frame, const std::uint64_t* from, std::uint64_t* to) {
  for (std::size_t at = 0; at < frame.words(); at += PlaneWords::most) {
    Words found{};
    for (int i = 1; i < lbm::D3Q19::directions; ++i) found |= moved(from + at, step_along(frame, i));
    const std::size_t left = std::min<std::size_t>(PlaneWords::most, frame.words() - at);
    __builtin_memcpy(to + at, &found, left * sizeof *to);
  }
}

std::uint32_t list_crossings(const BitFrame& frame, const FrameRows& wanted, const std::uint64_t* ends,
                             const std::uint64_t* own, std::uint32_t* place) {
  std::uint32_t n = 0;
  for (int first = 0; first < wanted.planes * frame.plane; first += PlaneWords::most) {
    const PlaneWords plane(frame, first, wanted);
    const std::size_t at = std::size_t(wanted.z) * frame.plane + first;
    const Words begins = load<Words>(ends + at) & load<Words>(plane.rows);
    for (int i = 1; i < lbm::D3Q19::directions; i += 2) {
      const std::ptrdiff_t step = step_along(frame, i);
      const Words in_block = load<Words>(own + at) | moved(own + at, step);
      const Words found = begins & moved(ends + at, step) & in_block;
      if (filled(found)) n += list_bits(frame, plane, found, i, place + n);
    }
  }
  return n;
}

}  // namespace

BitKernels bit_kernels() {
  return {mark_ball, mark_parts, list_links, list_beyond, widen, list_crossings};
}

}  // namespace silt::coupler::SILT_BUILD
