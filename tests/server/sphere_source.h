#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>

#include "server/session/scene_catalog.h"

namespace rimlight::server::test {

/// What the test and the sources of its scene share.
struct SphereProbe {
  std::atomic<int> moving_frames{0};
  std::atomic<int> exact_frames{0};
  std::atomic<int> abandoned{0};
  std::atomic<int> added_environments{0};
  std::atomic<int> sources{0};          // that there are
  std::function<void(int row)> on_row;  // called before each row of an exact frame
  std::atomic<double> budget_share{0};  // as it was last told
  std::atomic<bool> broken{false};      // every render throws Error
  /// Slices of work that frames leave, for the next edits or for the exact frame.
  std::atomic<int> slices_left{0};
  std::atomic<int> slices_for_exact{0};
  std::function<void()> on_slice;  // called within each
};

/// A frame source with a closed form: a white Lambert sphere under one distant light that the
/// state's rotation turns. Frames in motion have half the grey levels. Tiles are rows.
class SphereSource final : public FrameSource {
 public:
  SphereSource(int width, int height, std::shared_ptr<SphereProbe> probe)
      : width_(width), height_(height), probe_(std::move(probe)) {
    ++probe_->sources;
  }
  SphereSource(const SphereSource&) = delete;
  SphereSource& operator=(const SphereSource&) = delete;
  ~SphereSource() override { --probe_->sources; }

  void set_budget_share(double share) override { probe_->budget_share = share; }
  FrameReport render_moving(const DesignState& state, Rgb8Image& frame) override;
  bool render_exact(const DesignState& state, Rgb8Image& frame, FrameReport& report,
                    const std::function<bool()>& abandon) override;
  Unfinished improve(const std::function<bool()>& abandon) override;
  void add_environment(const std::shared_ptr<const Environment>&) override {
    ++probe_->added_environments;
  }

 private:
  void draw_row(const DesignState& state, int y, std::uint8_t mask, Rgb8Image& frame) const;

  int width_;
  int height_;
  std::shared_ptr<SphereProbe> probe_;
};

/// A scene of such sources with environments "day" and "night".
ServedScene sphere_scene(const std::string& name, int width, int height,
                         std::shared_ptr<SphereProbe> probe = std::make_shared<SphereProbe>());

}  // namespace rimlight::server::test
