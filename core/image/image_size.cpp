#include "core/image/image_size.h"

#include "core/base/error.h"

namespace rimlight {

void check_image_size(std::int64_t width, std::int64_t height, const std::string& where) {
  const auto fits = [](std::int64_t side) { return side >= 1 && side <= kLargestImageSide; };
  if (fits(width) && fits(height) && width * height <= kMostPixels) return;
  throw Error(where, "an image of " + std::to_string(width) + " × " + std::to_string(height),
              "sides from 1 to " + std::to_string(kLargestImageSide) + " and at most " +
                  std::to_string(kMostPixels) + " pixels");
}

}  // namespace rimlight
