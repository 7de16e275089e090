#include "core/import/matrix_source.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/bake/group.h"
#include "core/base/check.h"
#include "core/base/error.h"
#include "core/import/direction_list.h"

namespace rimlight {

MatrixSource::MatrixSource(const std::filesystem::path& path, int width, int height)
    : file_(path), pixels_{width, height} {
  const NpyArray& array = file_.array();
  const auto& shape = array.shape();
  const auto fail = [&](const std::string& found, const std::string& expected) {
    throw Error(array.name() + ": \"shape\"", found, expected);
  };
  if ((shape.size() != 2 && shape.size() != 3) || (shape.size() == 3 && shape[2] != 3)) {
    fail(array.shape_text(), "[receivers][directions] or [receivers][directions][3]");
  }
  const std::size_t receivers = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (shape[0] != receivers) {
    fail(std::to_string(shape[0]) + " receivers", std::to_string(receivers) + ": " +
                                                      std::to_string(width) + " × " +
                                                      std::to_string(height) + " pixels");
  }
  if (shape[1] == 0 || shape[1] > kMostDirections) {
    fail(std::to_string(shape[1]) + " directions", "1 to " + std::to_string(kMostDirections));
  }
  directions_ = shape[1];
  channels_ = shape.size() == 3 ? 3 : 1;
}

void MatrixSource::read_group(std::size_t first_receiver, std::span<float> rows) const {
  RIMLIGHT_CHECK_EQ(rows.size(), directions_ * kRowLanes);
  std::fill(rows.begin(), rows.end(), 0.0f);
  std::vector<float> values(directions_ * channels_);  // of one receiver
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    const auto [x, y] = pixels_.pixel(first_receiver + lane);
    if (x >= pixels_.width || y >= pixels_.height) continue;
    const auto receiver = static_cast<std::size_t>(y) * static_cast<std::size_t>(pixels_.width) +
                          static_cast<std::size_t>(x);
    file_.array().read(receiver * values.size(), values);
    for (std::size_t direction = 0; direction < directions_; ++direction) {
      for (std::size_t c = 0; c < 3; ++c) {
        rows[direction * kRowLanes + c * kGroupLanes + lane] =
            values[direction * channels_ + (channels_ == 3 ? c : 0)];
      }
    }
  }
}

}  // namespace rimlight
