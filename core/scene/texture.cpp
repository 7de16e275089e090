#include "core/scene/texture.h"

#include <algorithm>
#include <cmath>

namespace rimlight {
namespace {

/// Two neighbours along one side of the picture and the weight of the second.
struct Neighbours {
  int first, second;
  float weight;
};

Neighbours neighbours(double coordinate, int size) {
  const double wrapped = coordinate - std::floor(coordinate);  // may round up to 1
  const double place = wrapped * size - 0.5;
  const double floor = std::floor(place);
  const int first = static_cast<int>(floor);
  return {(first + size) % size, (first + 1) % size, static_cast<float>(place - floor)};
}

}  // namespace

Vec3f texture_at(const RgbImage& picture, const Mesh::TextureCoordinate& at) {
  const Neighbours x = neighbours(at.u, picture.width);
  const Neighbours y = neighbours(1 - static_cast<double>(at.v), picture.height);
  const auto row = [&](int line) {
    return picture.at(x.first, line) * (1 - x.weight) + picture.at(x.second, line) * x.weight;
  };
  return row(y.first) * (1 - y.weight) + row(y.second) * y.weight;
}

}  // namespace rimlight
