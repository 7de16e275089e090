#include "core/image/image_file.h"
#include "core/light/environment.h"

namespace rimlight {

Environment load_environment(const std::filesystem::path& path, EnvironmentLayout layout) {
  RgbImage image = read_radiance(path);
  return Environment(path.stem().string(), std::move(image), layout);
}

}  // namespace rimlight
