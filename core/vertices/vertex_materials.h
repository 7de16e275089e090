#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/relight/design_state.h"
#include "core/vertices/vertex_scene.h"

namespace rimlight {

/// The materials of a scene as a state shows them: as they were baked, with its edits. One thread
/// at a time.
class VertexMaterials {
 public:
  /// `stride` floats belong to a lobe: (visibility degree + 1)² and zeros. The scene must outlive
  /// it.
  VertexMaterials(const VertexScene& scene, std::size_t stride);

  /// True when any material changed; only lobes that did are projected again. Throws Error for a
  /// material that there is not, a colour that is not within 0 … 1, an exponent that is not within
  /// 0 … kMostExponent, a lobe that is none (check_lobe).
  bool set(const std::map<std::string, MaterialEdit>& edits);
  static constexpr double kMostExponent = 10'000;

  const VertexMaterial& at(std::uint32_t material) const { return materials_[material]; }
  bool has_highlight(std::uint32_t material) const { return has_highlight_[material] != 0; }
  /// What a convolution with the lobe multiplies harmonics by, coefficient by coefficient:
  /// [stride].
  const float* lobe(std::uint32_t material) const { return lobes_.data() + material * stride_; }

  /// What of the edits frames do not show, in words for people.
  std::vector<std::string> unshown() const;

 private:
  void project_lobe(std::size_t material);
  void find_highlights();
  void describe(const std::string& name, const MaterialEdit& edit,
                std::vector<std::string>& words) const;
  std::size_t find(const std::string& name) const;

  const VertexScene& scene_;
  std::size_t stride_;
  std::map<std::string, MaterialEdit> edits_;
  std::vector<VertexMaterial> materials_;
  std::vector<std::vector<double>> curves_;  // [material]: in the exponent's place, if not empty
  std::vector<std::uint8_t> has_highlight_;
  std::vector<std::uint8_t> can_have_highlight_;  // [material]: its vertices have visibility
  AlignedVector<float> lobes_;                    // [material][stride]
};

}  // namespace rimlight
