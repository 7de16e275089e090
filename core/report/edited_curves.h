#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/curves/curve_light.h"
#include "core/curves/curve_material_state.h"
#include "core/curves/curve_session.h"
#include "core/curves/curve_transport.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// The curves of a bake's materials as a session edits them, under one light, with T′ of the axes
/// that are edited. One thread at a time; computes on all cores. Bake and session outlive it.
class EditedCurves {
 public:
  /// As baked; nothing is made yet. `texels` of the bake's size. Throws Error for a bake without
  /// curves, and for a session that edits a material or a curve which the bake does not have.
  EditedCurves(const Bake& bake, const CurveSession& session, const CubeLight& texels);

  const CurveTransport& transport() const { return transport_; }
  const CurveSession& session() const { return session_; }
  std::uint32_t material_of(std::size_t stroke) const { return material_of_stroke_[stroke]; }
  /// The axis that a material is shown on.
  std::optional<CurveAxis> axis(std::uint32_t material) const { return axes_[material]; }
  /// The coefficients of that curve.
  CurveCoefficients target(std::uint32_t material) const;
  std::size_t row_count() const;

  /// T′ of a material for the axis as all curves are now, with its norms.
  struct Made {
    std::uint32_t material = 0;
    double transport_ms = 0, norms_ms = 0;
  };
  /// All materials, each for the axis that the session edits first, or any that it has.
  std::vector<Made> make_all();
  /// What a stroke needs: nothing where its material is shown on its axis already.
  std::optional<Made> make_for(std::size_t stroke);

  /// Sets the curve that a frame asks for.
  void go_to(const CurveSession::Place& place);
  /// What `image` ([panel][3][kPanelRows]) differs by from sums over all texels of the light:
  /// root of the squared error over all rows, estimated from `sample` of them.
  double distance_to_sums(std::span<const float> image, std::size_t sample) const;

 private:
  Made make(std::uint32_t material, std::optional<CurveAxis> axis);

  const CurveSession& session_;
  CurveReceivers receivers_;
  CurveSky sky_;
  CurveLight light_;
  CurveTransport transport_;
  std::vector<std::uint32_t> material_of_stroke_;
  std::vector<MaterialEdit> edits_;             // [material]
  std::vector<CurveMaterialState> states_;      // [material]
  std::vector<std::optional<CurveAxis>> axes_;  // [material]
  std::uint64_t version_ = 0;
};

}  // namespace rimlight
