#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/light/cube_light.h"
#include "core/transport/receivers.h"
#include "core/transport/transport.h"

namespace rimlight {

/// Random-sign sketches of transport, from which the error of an image is estimated without its
/// reference. Receiver r's channel c has a random sign s_c(r) and a row k(r); the sketch of an
/// image x is, for each channel,
///
///     (S x)_ck = Σ_{r: k(r) = k} s_c(r) x_c(r)
///
/// so that E ‖S x‖² = ‖x‖², with a relative variance of about 2/3 · 1/kSketchRows when x is spread
/// over the image: rows are shared by receivers all over it. (A sparse sign sketch: Charikar, Chen
/// and Farach-Colton 2004; Clarkson and Woodruff 2013.) A row holds the receivers at one place of a
/// group, of every third group or so.
inline constexpr std::size_t kSketchRows = 192;

/// +1 or −1.
float sketch_sign(std::size_t receiver, std::size_t channel);
/// The first of the 64 rows that a group's receivers have, in order.
std::size_t sketch_first_row(std::size_t group);

/// The sketch of M before anything is left out, summed up group by group in whole units, so that
/// the order changes nothing. Any thread may add any group. Memory: 4,608 bytes a column.
class SketchSums {
 public:
  /// `unit`: what sums count in. Entries of M are rounded to it, and to 2³⁰ units if they are
  /// larger.
  SketchSums(std::size_t column_count, float unit);

  /// A group's rows of M: [column][3][64].
  void add_group(std::size_t first_receiver, std::span<const float> rows);

  float unit() const { return unit_; }
  /// [column][3][kSketchRows], in units.
  std::span<const std::int64_t> sums() const { return sums_; }
  std::span<std::int64_t> sums() { return sums_; }

 private:
  static constexpr std::size_t kThirds = kSketchRows / PixelLayout::kGroupReceivers;

  float unit_;
  std::vector<std::int64_t> sums_;
  std::array<std::mutex, kThirds> mutexes_;  // of the groups whose rows begin there
};

/// What a bake keeps of its sketches: P̂ = S·M̂ of the stored transport, layer by layer, and
/// E = S·M − P̂, what compression took from it; 8 bits each, a scale for each row of them and
/// channel. And the squared norms of the columns of M̂, and of their layers.
struct Sketch {
  std::size_t column_count = 0;
  AlignedVector<std::int8_t> stored;       // P̂ [3][part][kSketchRows], times its scale
  AlignedVector<std::int8_t> error;        // E [3][column][kSketchRows], times its scale
  AlignedVector<float> stored_scale;       // [3][part]
  AlignedVector<float> error_scale;        // [3][column]
  AlignedVector<float> norm_squared;       // [3][column]: Σ over receivers of M̂², radiance
  AlignedVector<float> part_norm_squared;  // [3][part]

  friend bool operator==(const Sketch&, const Sketch&) = default;
};

/// From the sums and the stored transport: decodes all of it, in parallel over columns, in double.
/// A layer's radiance is what its blocks alone restore to.
Sketch make_sketch(const SketchSums& sums, const TransportView& stored,
                   const ReceiverValues& reflectance);

/// Sketches of two images, of one channel.
struct SketchedImages {
  std::array<float, kSketchRows> residual{};  // S·M̂·residual: of what time will mend
  std::array<float, kSketchRows> left_out{};  // S·(M − M̂)·target: of what compression took

  SketchedImages& operator+=(const SketchedImages& other);
  /// Estimates of ‖M̂·residual‖², and of ‖M·target − M̂·held‖² with residual = target − held.
  double residual_squared() const;
  double error_squared() const;
};

/// What the columns [first, first + count) add to the sketches. `channel` of the residual, [part],
/// and of the target, [column]. Where they are zero nothing is read. Float sums, relative error
/// 1e-5 of Σ|terms|. Any thread, allocates nothing.
SketchedImages sketch_images(const Sketch& sketch, std::size_t channel,
                             std::span<const float> residual, std::span<const float> target,
                             std::size_t first, std::size_t count);

}  // namespace rimlight
