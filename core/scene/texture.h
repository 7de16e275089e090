#pragma once

#include "core/image/image.h"
#include "core/math/vec.h"
#include "core/scene/scene.h"

namespace rimlight {

/// The picture at a texture coordinate: bilinear between pixel middles, repeated over the plane,
/// v = 0 at the bottom. The picture is not empty; the coordinate finite.
Vec3f texture_at(const RgbImage& picture, const Mesh::TextureCoordinate& at);

}  // namespace rimlight
