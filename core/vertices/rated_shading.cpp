#include "core/vertices/rated_shading.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/vertices/highlight_batch.h"

namespace rimlight {
namespace {

constexpr int kTileSide = static_cast<int>(TileImage::kSide);
/// A tile, and the first row and column of the next ones: the grid goes on there.
constexpr int kReach = kTileSide + 1;
/// Pixels are evaluated by so many of the grid in a square, as in shade_tile().
constexpr int kBlockSide = 8;

/// What a thread holds of a tile.
struct Scratch {
  std::array<Vec3f, static_cast<std::size_t>(kReach) * kReach> known;  // evaluated, not weighed
  std::array<std::uint32_t, kTileSide * kTileSide> samples;            // their places in `known`
  std::array<Vec3f, kTileSide * kTileSide> evaluated;                  // at each of them
  std::size_t sample_count = 0;

  static Scratch& of_thread() {
    thread_local Scratch scratch;
    return scratch;
  }
};

/// grid_weights() of every place in a cell and every set of corners, looked up.
class CellWeights {
 public:
  static const CellWeights& all() {
    static const CellWeights weights;
    return weights;
  }
  const std::array<float, 4>& of(int spacing, int u, int v, GridCorners corners) const {
    const auto cell = static_cast<std::size_t>((spacing == 4 ? 16 : 0) + 4 * v + u);
    return weights_[16 * cell + corners];
  }

 private:
  CellWeights() {
    for (const int spacing : {2, 4}) {
      for (int place = 0; place < spacing * spacing; ++place) {
        const int u = place % spacing, v = place / spacing;
        for (int corners = 1; corners < 16; ++corners) {
          const auto bits = static_cast<GridCorners>(corners);
          const auto found = grid_weights(u, v, spacing, bits);
          auto& to = weights_[static_cast<std::size_t>(&of(spacing, u, v, bits) - weights_.data())];
          for (std::size_t i = 0; i < 4; ++i) to[i] = found[i].weight;
        }
      }
    }
  }
  std::array<std::array<float, 4>, 32 * 16> weights_{};
};

class RatedTile {
 public:
  RatedTile(const VertexShading& shading, const HighlightPlan& plan, HighlightRate rate, int left,
            int top)
      : shading_(shading),
        plan_(plan),
        rate_(rate),
        left_(left),
        top_(top),
        step_(shading.view.step()),
        spacing_(std::max(spacing(rate), step_)),
        width_(std::min(kTileSide, shading.view.width() - left)),
        height_(std::min(kTileSide, shading.view.height() - top)),
        batch_(HighlightBatch::of_thread(shading)),
        scratch_(Scratch::of_thread()) {
    scratch_.sample_count = 0;
  }

  void evaluate() {
    const int side = kBlockSide * spacing_;
    for (int y = 0; y < height_; y += side) {
      for (int x = 0; x < width_; x += side) evaluate_block(x, y, side);
    }
    evaluate_beyond();
    flush();
  }

  void shade(TileImage& image, MeasuredError& error) {
    for (int y = 0; y < height_; y += step_) {
      for (int x = 0; x < width_; x += step_) {
        if (shading_.view.hit(0, left_ + x, top_ + y).is_miss()) continue;
        const auto place = static_cast<std::size_t>(y * kTileSide + x);
        add_matt(shading_, 0, left_ + x, top_ + y, 1, place, image);
        if (!is_shining(x, y)) continue;
        const GridCorners corners = corners_at(x, y);
        error.interpolated += corners != 0 ? 1 : 0;
        const Vec3f radiance =
            weight_at(x, y) * (corners == 0 ? scratch_.known[at(x, y)] : mixed(x, y, corners));
        for (std::size_t c = 0; c < 3; ++c) {
          image.channel[c][place] += radiance[static_cast<int>(c)];
        }
      }
    }
    for (std::size_t i = 0; i < scratch_.sample_count; ++i) compare(i, error);
  }

 private:
  static std::size_t at(int x, int y) { return static_cast<std::size_t>(y * kReach + x); }
  bool is_shining(int x, int y) const {
    return !shading_.view.hit(0, left_ + x, top_ + y).is_miss() &&
           has_highlight(shading_, 0, left_ + x, top_ + y);
  }
  GridCorners corners_at(int x, int y) const { return plan_.corners(rate_, left_ + x, top_ + y); }
  const Vec3f& weight_at(int x, int y) const {
    return material_at(shading_, 0, left_ + x, top_ + y).highlight;
  }

  void evaluate_block(int left, int top, int side) {
    for (int y = top; y < std::min(top + side, height_); y += step_) {
      for (int x = left; x < std::min(left + side, width_); x += step_) {
        // Most pixels are interpolated: that is known without a look at the surface.
        const bool is_interpolated = corners_at(x, y) != 0;
        if (is_interpolated && !HighlightPlan::is_sample(left_ + x, top_ + y)) continue;
        if (!is_shining(x, y)) continue;
        add(x, y, is_interpolated);
      }
    }
  }

  /// The grid's pixels in the row below and the column to the right.
  void evaluate_beyond() {
    const bool has_right = left_ + kTileSide < shading_.view.width();
    const bool has_below = top_ + kTileSide < shading_.view.height();
    if (has_right) {
      for (int y = 0; y < height_; y += spacing_) add_corner(kTileSide, y);
    }
    if (has_below) {
      for (int x = 0; x < width_; x += spacing_) add_corner(x, kTileSide);
    }
    if (has_right && has_below) add_corner(kTileSide, kTileSide);
  }
  void add_corner(int x, int y) {
    if (is_shining(x, y)) add(x, y, false);
  }

  static constexpr std::uint32_t kSample = 0x80000000u;
  void add(int x, int y, bool is_sample) {
    batch_.add(shading_, 0, left_ + x, top_ + y,
               static_cast<std::uint32_t>(at(x, y)) | (is_sample ? kSample : 0));
    if (batch_.is_full()) flush();
  }
  void flush() {
    if (batch_.size() == 0) return;
    batch_.evaluate(shading_);
    for (std::size_t i = 0; i < batch_.size(); ++i) {
      const std::uint32_t place = batch_.tag(i) & ~kSample;
      if ((batch_.tag(i) & kSample) != 0) {
        scratch_.samples[scratch_.sample_count] = place;
        scratch_.evaluated[scratch_.sample_count++] = batch_.radiance(i);
      } else {
        scratch_.known[place] = batch_.radiance(i);
      }
    }
    batch_.clear();
  }

  Vec3f mixed(int x, int y, GridCorners corners) const {
    const int u = x % spacing_, v = y % spacing_;
    const auto& weights = weights_.of(spacing_, u, v, corners);
    const std::size_t first = at(x - u, y - v);
    const auto right = static_cast<std::size_t>(spacing_), below = right * kReach;
    const std::array<std::size_t, 4> places{first, first + right, first + below,
                                            first + below + right};
    Vec3f sum;
    for (std::size_t i = 0; i < 4; ++i) {
      if (weights[i] > 0) sum += scratch_.known[places[i]] * weights[i];
    }
    return sum;
  }

  void compare(std::size_t i, MeasuredError& error) const {
    const int x = static_cast<int>(scratch_.samples[i]) % kReach;
    const int y = static_cast<int>(scratch_.samples[i]) / kReach;
    const Vec3f difference =
        weight_at(x, y) * (scratch_.evaluated[i] - mixed(x, y, corners_at(x, y)));
    ++error.samples;
    error.square += static_cast<double>(dot(difference, difference));
  }

  const VertexShading& shading_;
  const HighlightPlan& plan_;
  HighlightRate rate_;
  int left_, top_, step_, spacing_, width_, height_;
  HighlightBatch& batch_;
  Scratch& scratch_;
  const CellWeights& weights_ = CellWeights::all();
};

}  // namespace

MeasuredError& MeasuredError::operator+=(const MeasuredError& other) {
  interpolated += other.interpolated;
  samples += other.samples;
  square += other.square;
  return *this;
}

double MeasuredError::square_of_all() const {
  if (samples == 0) return 0;
  return square * static_cast<double>(interpolated) / static_cast<double>(samples);
}

double shade_tile(const VertexShading& shading, const HighlightPlan& plan, HighlightRate rate,
                  int left, int top, TileImage& image, MeasuredError& error) {
  for (auto& channel : image.channel) channel.fill(0);
  RatedTile tile(shading, plan, rate, left, top);
  tile.evaluate();
  tile.shade(image, error);
  if (shading.view.step() == 2) spread_known(image);
  return sum_of_squares(image);
}

}  // namespace rimlight
