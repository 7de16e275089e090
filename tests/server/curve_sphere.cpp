#include "tests/server/curve_sphere.h"

#include <algorithm>
#include <cmath>

#include "core/math/rotation.h"

namespace rimlight::server::test {
namespace {

std::vector<CurveMaterial> materials() {
  return {{"pearl",
           {.model = BrdfModel::cook_torrance,
            .albedo = {0.35f, 0.3f, 0.28f},
            .specular = {1, 1, 1},
            .roughness = 0.3f,
            .eta = {1.6f, 1.6f, 1.6f}}},
          {"red & blue",
           {.model = BrdfModel::blinn_phong,
            .albedo = {0.5f, 0.05f, 0.1f},
            .specular = {0.1f, 0.1f, 0.4f},
            .exponent = 30}},
          {"brushed",
           {.model = BrdfModel::ward,
            .albedo = {0.1f, 0.1f, 0.1f},
            .specular = {0.5f, 0.5f, 0.5f},
            .roughness = 0.3f,
            .roughness_across = 0.15f}}};
}

template <typename T, typename Field>
void replace(const std::optional<T>& given, Field& field) {
  if (given) field = static_cast<Field>(*given);
}

Vec3d reflected(const CurvedBrdf& brdf, bool is_measured, const Vec3d& in, const Vec3d& out) {
  if (!is_measured) return evaluate(brdf, in, out);
  FactoredBrdf factors = made_up_measured();
  if (brdf.half_angle) factors.half_angle = *brdf.half_angle;
  if (brdf.difference_angle) factors.difference_angle = *brdf.difference_angle;
  return evaluate(factors, in, out);
}

class CurveSphere final : public FrameSource {
 public:
  explicit CurveSphere(int side) : side_(side) {}

  FrameReport render_moving(const DesignState& state, Rgb8Image& frame) override {
    draw(state, frame);
    return {};
  }
  bool render_exact(const DesignState& state, Rgb8Image& frame, FrameReport& report,
                    const std::function<bool()>& /*abandon*/) override {
    draw(state, frame);
    report = {};
    report.exact = true;
    return true;
  }

 private:
  void draw(const DesignState& state, Rgb8Image& frame) const {
    frame.resize(side_, side_);
    std::size_t at = 0;
    const std::vector<CurveMaterial> all = materials();
    std::vector<CurvedBrdf> brdfs;
    std::vector<bool> is_measured;
    for (const CurveMaterial& material : all) {
      const auto found = state.materials.find(material.name);
      const MaterialEdit edit = found == state.materials.end() ? MaterialEdit() : found->second;
      brdfs.push_back(edited(material, edit));
      is_measured.push_back(edit.measured.has_value());
    }
    for (int y = 0; y < side_; ++y) {
      for (int x = 0; x < side_; ++x) {
        const std::size_t third = std::min<std::size_t>(2, static_cast<std::size_t>(3 * x / side_));
        const Vec3d colour = shade(state, brdfs[third], is_measured[third], x, y);
        for (int c = 0; c < 3; ++c) {
          const double shown = std::pow(std::clamp(colour[c], 0.0, 1.0), 1 / 2.2);
          frame.bytes[at++] = static_cast<std::uint8_t>(255 * shown);
        }
      }
    }
  }

  Vec3d shade(const DesignState& state, const CurvedBrdf& brdf, bool is_measured, int x,
              int y) const {
    const double u = (2 * (x + 0.5) / side_ - 1) / 0.95;
    const double v = (1 - 2 * (y + 0.5) / side_) / 0.95;
    if (u * u + v * v >= 1) return {};
    const Vec3d normal{u, v, std::sqrt(1 - u * u - v * v)};
    const Vec3d light = rotated(state.rotation, normalized(Vec3d{0.4, 0.7, 0.6}));
    const Vec3d tangent = normalized(cross(Vec3d{0, 1, 0}, normal));
    const Vec3d across = cross(normal, tangent);
    const auto local = [&](const Vec3d& d) {
      return Vec3d{dot(d, tangent), dot(d, across), dot(d, normal)};
    };
    const Vec3d in = local(light);
    return reflected(brdf, is_measured, in, local({0, 0, 1})) *
           (3 * std::max(0.0, in.z) * std::exp2(state.exposure_stops));
  }

  int side_;
};

}  // namespace

FactoredBrdf made_up_measured() {
  FactoredBrdf brdf;
  for (std::size_t i = 0; i < kCurveBins; ++i) {
    const double half = bin_begin(CurveAxis::half_angle, static_cast<double>(i) + 0.5);
    const double lobe = 1.5 * std::exp(-half * half / 0.02) + 0.05;
    brdf.half_angle.values[i] = Vec3f(Vec3d{lobe, 0.8 * lobe, 0.3 * lobe});
    const auto turn = static_cast<double>(i) / kCurveBins;
    brdf.difference_angle.values[i] = Vec3f::filled(static_cast<float>(1 + 0.3 * turn));
  }
  for (std::size_t i = 0; i < kRestKnots; ++i) {
    brdf.rest[i] = Vec3f::filled(1 - 0.3f * static_cast<float>(i) / (kRestKnots - 1));
  }
  brdf.error = {{0.1, 0.11, 0.12}, {0.05, 0.06, 0.07}};
  return brdf;
}

CurvedBrdf edited(const CurveMaterial& material, const MaterialEdit& edit) {
  CurvedBrdf result{material.brdf, {}, {}};
  Brdf& brdf = result.base;
  replace(edit.albedo, brdf.albedo);
  replace(edit.specular, brdf.specular);
  replace(edit.exponent, brdf.exponent);
  replace(edit.exponent_across, brdf.exponent_across);
  replace(edit.roughness, brdf.roughness);
  replace(edit.roughness_across, brdf.roughness_across);
  replace(edit.eta, brdf.eta);
  replace(edit.k, brdf.k);
  if (edit.half_angle) result.half_angle = curve_of(CurveAxis::half_angle, *edit.half_angle);
  if (edit.difference_angle) {
    result.difference_angle = curve_of(CurveAxis::difference_angle, *edit.difference_angle);
  }
  if (edit.measured) return result;
  // A curve that stays from a measured BRDF whose place the model took back has no factor here.
  if (!factor(brdf, CurveAxis::half_angle, 0)) result.half_angle.reset();
  if (!factor(brdf, CurveAxis::difference_angle, 0)) result.difference_angle.reset();
  return result;
}

ServedScene curve_sphere_scene(const std::string& name, int side) {
  ServedScene scene;
  scene.name = name;
  scene.environments = {"lamp"};
  scene.width = scene.height = side;
  scene.editable = materials();
  scene.measured = {{"gold", made_up_measured()}};
  scene.make_source = [side] { return std::make_unique<CurveSphere>(side); };
  return scene;
}

}  // namespace rimlight::server::test
