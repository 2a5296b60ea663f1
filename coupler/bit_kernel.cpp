// Built once an instruction set.
#include <algorithm>
#include <bit>
#include <cmath>

#include "coupler/bit_kernels.hpp"

#if defined(SILT_ISA_avx512)
#include <immintrin.h>
#endif

namespace silt::coupler::SILT_ISA {

namespace {

/// Where bit b of a word lies from the word's first cell, as a place.
struct PlaceOfBit {
  std::uint32_t at[64];
  explicit PlaceOfBit(int pitch) {
    for (int b = 0; b < 64; ++b)
      at[b] = pitch >= 64 ? lbm::link_place(b, 0, 0) : lbm::link_place(b % pitch, b / pitch, 0);
  }
};

/// Place of the first cell of word w of a plane.
std::uint32_t place_of_word(const BitFrame& frame, int w, int z) {
  if (frame.pitch >= 64) {
    const int a_row = frame.pitch / 64;
    return lbm::link_place(w % a_row * 64, w / a_row, z);
  }
  return lbm::link_place(0, w * (64 / frame.pitch), z);
}

/// The places of the set bits of some words, one after the other; returns how many. Up to link_lanes more may
/// be written.
std::uint32_t list_bits_plain(const BitFrame& frame, const std::uint64_t* words, int first, int count, int z,
                              const PlaceOfBit& place, std::uint32_t* out) {
  std::uint32_t n = 0;
  for (int w = 0; w < count; ++w) {
    std::uint64_t bits = words[w];
    if (!bits) continue;
    const std::uint32_t base = place_of_word(frame, first + w, z);
    for (; bits; bits &= bits - 1) out[n++] = base + place.at[std::countr_zero(bits)];
  }
  return n;
}

#if defined(SILT_ISA_avx512)
/// The same, 16 bits at a time: the numbers of a word's set bits, compressed, then widened.
__attribute__((target("avx512vbmi2,avx512vbmi,avx512bw"))) std::uint32_t list_bits_compressed(
    const BitFrame& frame, const std::uint64_t* words, int first, int count, int z, std::uint32_t* out) {
  alignas(64) std::uint8_t ramp[64];
  for (int b = 0; b < 64; ++b) ramp[b] = std::uint8_t(b);
  const __m512i numbers = _mm512_load_si512(ramp);
  const int log_pitch = frame.pitch == 8 ? 3 : frame.pitch == 16 ? 4 : frame.pitch == 32 ? 5 : 6;
  const __m512i in_row = _mm512_set1_epi32((1 << log_pitch) - 1);
  const __m128i to_row = _mm_cvtsi32_si128(log_pitch);
  std::uint32_t n = 0;
  for (int w = 0; w < count; ++w) {
    const std::uint64_t bits = words[w];
    if (!bits) continue;
    const __m512i base = _mm512_set1_epi32(int(place_of_word(frame, first + w, z)));
    __m512i set = _mm512_maskz_compress_epi8(bits, numbers);
    int left = std::popcount(bits);
    for (;;) {
      const __m512i bit = _mm512_cvtepu8_epi32(_mm512_castsi512_si128(set));
      const __m512i row = _mm512_slli_epi32(_mm512_srl_epi32(bit, to_row), lbm::place_bits);
      const __m512i cell = _mm512_or_si512(_mm512_and_si512(bit, in_row), row);
      _mm512_storeu_si512(out + n, _mm512_add_epi32(cell, base));
      if (left <= 16) break;
      n += 16, left -= 16;
      set = _mm512_alignr_epi32(set, set, 4);
    }
    n += std::uint32_t(left);
  }
  return n;
}
#endif

std::uint32_t list_bits(const BitFrame& frame, const std::uint64_t* words, int first, int count, int z,
                        const PlaceOfBit& place, std::uint32_t* out) {
#if defined(SILT_ISA_avx512)
  static const bool compresses = __builtin_cpu_supports("avx512vbmi2");
  if (compresses) return list_bits_compressed(frame, words, first, count, z, out);
#endif
  return list_bits_plain(frame, words, first, count, z, place, out);
}

/// The stream moved so that a cell's bit is that of the cell `shift` bits further on, for words [0, n).
inline void moved(const std::uint64_t* stream, std::ptrdiff_t shift, int n, std::uint64_t* out) {
  const std::uint64_t* const from = stream + (shift >> 6);
  const int s = int(shift & 63);
  if (s == 0)
    for (int w = 0; w < n; ++w) out[w] = from[w];
  else
    for (int w = 0; w < n; ++w) out[w] = from[w] >> s | from[w + 1] << (64 - s);
}

}  // namespace

/// Row by row, where the line of cell centres is inside, in closed form.
void mark_sphere(const BitFrame& frame, const SphereInFrame& ball, std::uint64_t* words) {
  constexpr int most = 64;  // rows at a time
  double first[most], last[most];
  for (int z = 2; z < frame.size.z - 2; ++z) {
    const double rz = (ball.low.z + z + 0.5) - ball.z;
    for (int y0 = 2; y0 < frame.size.y - 2; y0 += most) {
      const int n = std::min(most, frame.size.y - 2 - y0);
      for (int k = 0; k < n; ++k) {
        const double ry = (ball.low.y + (y0 + k) + 0.5) - ball.y;
        const double h2 = ball.radius * ball.radius - ry * ry - rz * rz;
        const double half = std::sqrt(h2 < 0 ? 0 : h2), centre = ball.x - 0.5;
        first[k] = h2 < 0 ? 1 : std::ceil(centre - half) - ball.low.x;
        last[k] = h2 < 0 ? 0 : std::floor(centre + half) - ball.low.x;
      }
      for (int k = 0; k < n; ++k) {
        const int from = int(std::max(first[k], 2.0)), to = int(std::min(last[k], frame.size.x - 3.0));
        if (from > to) continue;
        const std::size_t row = std::size_t(z) * frame.plane * 64 + std::size_t(y0 + k) * frame.pitch;
        if (frame.pitch <= 64) {
          words[row >> 6] |= (~std::uint64_t{0} >> (63 - (to - from))) << ((row & 63) + from);
        } else {
          for (int x = from; x <= to; ++x) words[(row + x) >> 6] |= std::uint64_t{1} << (x & 63);
        }
      }
    }
  }
}

/// The links of planes [z0, z1) of the frame: of each direction a list, then one of the narrow ones, both
/// filled up. Returns the room taken. Both `place` and `apart` need link_lanes of room more than that.
std::uint32_t list_links(const BitFrame& frame, int z0, int z1, const LinkBits& bits, std::uint32_t* place,
                         std::uint32_t* apart, LinkCounts* counts) {
  constexpr int most = 64;  // words at a time
  const PlaceOfBit table(frame.pitch);
  std::uint32_t used = 0;
  const auto fill = [&](std::uint32_t n) {  // with copies of the last
    if (n == 0) return;
    const std::uint32_t padded = (n + lbm::link_lanes - 1) & ~std::uint32_t(lbm::link_lanes - 1);
    for (std::uint32_t k = n; k < padded; ++k) place[used + k] = place[used + n - 1];
    used += padded;
  };
  for (int i = 1; i < lbm::directions; ++i) {
    const lbm::Int3 c = lbm::c[i];
    const std::ptrdiff_t step =
        c.x + std::ptrdiff_t(frame.pitch) * c.y + std::ptrdiff_t(frame.plane) * 64 * c.z;
    std::uint32_t n = 0, narrow = 0;
    for (int z = z0; z < z1; ++z)
      for (int w0 = 0; w0 < frame.plane; w0 += most) {
        const int words = std::min(most, frame.plane - w0);
        const std::size_t at = std::size_t(z) * frame.plane + w0;
        std::uint64_t cut[most], back[most], any = 0;
        moved(bits.body + at, step, words, cut);
        for (int w = 0; w < words; ++w) cut[w] &= bits.open[at + w];
        if (bits.reads_behind) {
          moved(bits.solid + at, -step, words, back);
          for (int w = 0; w < words; ++w) back[w] &= cut[w], any |= back[w];
          for (int w = 0; w < words; ++w) cut[w] &= ~back[w];
        }
        n += list_bits(frame, cut, w0, words, z - z0, table, place + used + n);
        if (any) narrow += list_bits(frame, back, w0, words, z - z0, table, apart + narrow);
      }
    counts[i] = {n, narrow};
    fill(n);
    for (std::uint32_t k = 0; k < narrow; ++k) place[used + k] = apart[k];
    fill(narrow);
  }
  return used;
}

/// q of |r + q c| = radius: the smaller root, within [0, 1].
template <class T>
void sphere_distances(const std::uint32_t* place, int padded, const lbm::SurfaceFrame& frame,
                      lbm::Int3 corner, int direction, double radius, T* q) {
  const lbm::Int3 c = lbm::c[direction], far = corner - frame.cell;
  const T ox = T(frame.offset[0]), oy = T(frame.offset[1]), oz = T(frame.offset[2]);
  const T a = T(lbm::norm2(direction)), inverse = T(1) / a, r2 = T(radius * radius);
  const T cx = T(c.x), cy = T(c.y), cz = T(c.z);
  constexpr std::uint32_t low = (1u << lbm::place_bits) - 1;
  for (int l = 0; l < padded; ++l) {
    const std::int32_t px = place[l] & low, py = place[l] >> lbm::place_bits & low,
                       pz = place[l] >> (2 * lbm::place_bits);
    const T x = T(px + far.x) + ox, y = T(py + far.y) + oy, z = T(pz + far.z) + oz;
    const T b = x * cx + y * cy + z * cz;
    const T discriminant = b * b - a * ((x * x + y * y + z * z) - r2);
    const T root = (-b - std::sqrt(discriminant < T(0) ? T(0) : discriminant)) * inverse;
    q[l] = root < T(0) ? T(0) : root > T(1) ? T(1) : root;
  }
}

template void sphere_distances(const std::uint32_t*, int, const lbm::SurfaceFrame&, lbm::Int3, int, double,
                               float*);
template void sphere_distances(const std::uint32_t*, int, const lbm::SurfaceFrame&, lbm::Int3, int, double,
                               double*);

}  // namespace silt::coupler::SILT_ISA
