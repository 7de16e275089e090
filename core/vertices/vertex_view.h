#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/scene/g_buffer.h"
#include "core/transport/vertex_transport.h"

namespace rimlight {

/// What one camera sees of a mesh of vertices, kept while it stands still: a G-buffer for each
/// point that is sampled in a pixel, the mirrored directions of what has a highlight, the vertices
/// that are needed. The same for the same camera and detail, whatever came before. One thread at a
/// time; computes on all cores.
class VertexView {
 public:
  struct Settings {
    int width = 0, height = 0;
    std::size_t highlight_count = 0;  // the first so many vertices have a highlight
    std::vector<PixelPoint> points;   // of a pixel; all count the same
  };
  /// `mesh` and its tree; the mesh must outlive the view.
  VertexView(const VertexMesh& mesh, std::shared_ptr<const TriangleTree> tree,
             const Settings& settings);

  /// Traces what is missing. The camera has passed check_camera(). True when anything changed.
  bool look(const Camera& camera, GBufferDetail detail);
  /// What of a detail of this camera is known already.
  GBufferDetail detail_of(const Camera& camera) const;

  int width() const { return width_; }
  int height() const { return height_; }
  GBufferDetail detail() const { return detail_; }
  /// Pixels from one that is known to the next, both ways: 2 in a coarse view, else 1.
  int step() const { return detail_ == GBufferDetail::coarse ? 2 : 1; }

  std::size_t layer_count() const { return layers_.size(); }
  const PrimaryHit& hit(std::size_t layer, int x, int y) const {
    return layers_[layer].hits.at(x, y);
  }
  /// Where a pixel's surface mirrors the eye to, unit; zero where it has no highlight, or is seen
  /// from behind.
  const Vec3f& mirrored(std::size_t layer, int x, int y) const {
    return layers_[layer].mirrored[index(x, y)];
  }

  bool has_highlight(std::size_t layer, int x, int y) const {
    return highlight_count_ > 0 && mirrored(layer, x, y) != Vec3f();
  }
  /// Along the pixel's ray, in units of length, where it has a highlight.
  float distance(std::size_t layer, int x, int y) const {
    return layers_[layer].distances[index(x, y)];
  }
  /// How much farther a surface turned by 45° is from a pixel to the next, as a share of its
  /// distance.
  double depth_of_pixel() const;

  /// Share of each pixel that surfaces cover: [height][width]. In a coarse view four pixels have
  /// the upper left one's.
  std::span<const float> coverage() const { return coverage_; }
  /// What the hits need, rising; and of those the ones with a highlight.
  std::span<const std::uint32_t> vertices() const { return vertices_; }
  std::span<const std::uint32_t> highlight_vertices() const;
  /// How many of the hits are from behind, where nothing was baked.
  double share_from_behind() const { return share_from_behind_; }

 private:
  struct Layer {
    GBuffer hits;
    std::vector<Vec3f> mirrored;   // [height][width]
    std::vector<float> distances;  // [height][width]
  };
  struct Counts {
    std::size_t hits = 0, from_behind = 0;
  };

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  Counts read_row(Layer& layer, const CameraRays& rays, int y);
  void find_coverage();
  void find_vertices();

  const VertexMesh& mesh_;
  int width_, height_;
  std::size_t highlight_count_;
  std::vector<Layer> layers_;
  Camera camera_;
  GBufferDetail detail_ = GBufferDetail::none;
  std::vector<float> coverage_;
  std::vector<std::uint8_t> needed_;  // [vertex]
  std::vector<std::uint32_t> vertices_;
  double share_from_behind_ = 0;
};

}  // namespace rimlight
