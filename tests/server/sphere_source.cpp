#include "tests/server/sphere_source.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace rimlight::server::test {
namespace {

void fail_if_broken(const SphereProbe& probe) {
  if (probe.broken) throw Error("sphere", "a broken source", "a whole one");
}

Unfinished unfinished(const SphereProbe& probe) {
  if (probe.slices_for_exact > 0) return Unfinished::exact_frame;
  return probe.slices_left > 0 ? Unfinished::next_edits : Unfinished::nothing;
}

std::vector<std::string> unshown(const DesignState& state) {
  if (!state.view) return {};
  return {"the moved camera"};
}

}  // namespace

Unfinished SphereSource::improve(const std::function<bool()>& abandon) {
  if (probe_->on_slice) probe_->on_slice();
  if (!abandon()) {
    if (probe_->slices_left > 0) --probe_->slices_left;
    if (probe_->slices_for_exact > 0) --probe_->slices_for_exact;
  }
  return unfinished(*probe_);
}

void SphereSource::draw_row(const DesignState& state, int y, std::uint8_t mask,
                            Rgb8Image& frame) const {
  const Vec3d light = rotated(state.rotation, normalized(Vec3d{0.3, 0.8, 0.5}));
  const double scale =
      255 * std::exp2(state.exposure_stops) * (state.environment == "night" ? 0.3 : 1.0);
  for (int x = 0; x < width_; ++x) {
    const double u = 2 * (x + 0.5) / width_ - 1;
    const double v = 1 - 2 * (y + 0.5) / height_;
    const double d2 = u * u + v * v;
    const double cosine = d2 < 1 ? dot(light, Vec3d{u, v, std::sqrt(1 - d2)}) : 0.0;
    const auto level = static_cast<std::uint8_t>(std::clamp(cosine * scale, 0.0, 255.0));
    std::uint8_t* const pixel =
        frame.bytes.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                  static_cast<std::size_t>(x));
    std::fill_n(pixel, 3, static_cast<std::uint8_t>(level & mask));
  }
}

FrameReport SphereSource::render_moving(const DesignState& state, Rgb8Image& frame) {
  fail_if_broken(*probe_);
  frame.resize(width_, height_);
  for (int y = 0; y < height_; ++y) draw_row(state, y, 0xfe, frame);
  ++probe_->moving_frames;
  FrameReport report;
  report.terms = 30;
  report.residual = 0.5;
  report.unshown = unshown(state);
  report.unfinished = unfinished(*probe_);
  return report;
}

bool SphereSource::render_exact(const DesignState& state, Rgb8Image& frame, FrameReport& report,
                                const std::function<bool()>& abandon) {
  fail_if_broken(*probe_);
  Rgb8Image drawn(width_, height_);
  for (int y = 0; y < height_; ++y) {
    if (probe_->on_row) probe_->on_row(y);
    if (abandon && abandon()) {
      ++probe_->abandoned;
      return false;
    }
    draw_row(state, y, 0xff, drawn);
  }
  frame = std::move(drawn);
  ++probe_->exact_frames;
  report = {};
  report.exact = true;
  report.terms = 1536;
  report.unshown = unshown(state);
  return true;
}

ServedScene sphere_scene(const std::string& name, int width, int height,
                         std::shared_ptr<SphereProbe> probe) {
  ServedScene scene;
  scene.name = name;
  scene.environments = {"day", "night"};
  scene.width = width;
  scene.height = height;
  scene.make_source = [width, height, probe = std::move(probe)] {
    return std::make_unique<SphereSource>(width, height, probe);
  };
  return scene;
}

}  // namespace rimlight::server::test
