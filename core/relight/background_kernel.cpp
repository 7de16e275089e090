#include "core/relight/background_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/relight/background_kernel.cpp"  // compiled once per SIMD target
#include <hwy/foreach_target.h>                                  // must come before highway.h
// clang-format off: the order matters
#include <hwy/highway.h>
// clang-format on

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace rimlight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Lanes = hn::Vec<Floats>;
using Integers = hn::RebindToSigned<Floats>;
using Texel = hn::CappedTag<float, 4>;

/// Where directions meet the bordered faces: the texel below and left, and the way to the next.
struct alignas(64) Places {
  std::int32_t texel[kLookUps];
  float across[kLookUps], up[kLookUps];
};

/// One coordinate on a face, in [−1, 1], to the texel before it and the way to the next. The middle
/// of texel c lies at c + 1 of the bordered face.
HWY_INLINE hn::Vec<Integers> split(Floats d, Lanes coordinate, int size, Lanes& way) {
  const Integers i32;
  const Lanes half = hn::Set(d, static_cast<float>(size) / 2);
  const Lanes place = hn::MulAdd(hn::Add(coordinate, hn::Set(d, 1.0f)), half, hn::Set(d, 0.5f));
  const auto before =
      hn::Min(hn::Max(hn::ConvertTo(i32, place), hn::Zero(i32)), hn::Set(i32, size));
  way = hn::Sub(place, hn::ConvertTo(d, before));
  return before;
}

/// cube::face_point() in floats: on every face right and up are positive axes, in turn on the faces
/// of positive axes, in the other order on those of negative ones (right × up = axis).
void find_places(int size, const float (&turn)[3][3], std::size_t count,
                 const BackgroundLookUps& look_ups, Places& places) {
  const Floats d;
  const Integers i32;
  const auto side = hn::Set(i32, size + 2);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Lanes from[3] = {hn::Load(d, look_ups.x + i), hn::Load(d, look_ups.y + i),
                           hn::Load(d, look_ups.z + i)};
    Lanes axis[3];
    for (int a = 0; a < 3; ++a) {
      axis[a] = hn::MulAdd(
          hn::Set(d, turn[a][0]), from[0],
          hn::MulAdd(hn::Set(d, turn[a][1]), from[1], hn::Mul(hn::Set(d, turn[a][2]), from[2])));
    }
    const Lanes x = axis[0], y = axis[1], z = axis[2];
    const auto on_x = hn::And(hn::Ge(hn::Abs(x), hn::Abs(y)), hn::Ge(hn::Abs(x), hn::Abs(z)));
    const auto on_y = hn::AndNot(on_x, hn::Ge(hn::Abs(y), hn::Abs(z)));
    const auto choose = [&](Lanes of_x, Lanes of_y, Lanes of_z) {
      return hn::IfThenElse(on_x, of_x, hn::IfThenElse(on_y, of_y, of_z));
    };
    const Lanes major = choose(x, y, z);
    const auto negative = hn::Lt(major, hn::Zero(d));
    const Lanes scale = hn::Div(hn::Set(d, 1.0f), hn::Abs(major));
    const Lanes right = hn::Mul(choose(y, z, x), scale), above = hn::Mul(choose(z, x, y), scale);
    Lanes across, up;
    const auto column = split(d, hn::IfThenElse(negative, above, right), size, across);
    const auto row = split(d, hn::IfThenElse(negative, right, above), size, up);
    const Lanes face = hn::Add(choose(hn::Zero(d), hn::Set(d, 2.0f), hn::Set(d, 4.0f)),
                               hn::IfThenElseZero(negative, hn::Set(d, 1.0f)));
    const auto rows = hn::Add(hn::Mul(hn::ConvertTo(i32, face), side), row);
    hn::Store(hn::Add(hn::Mul(rows, side), column), i32, places.texel + i);
    hn::Store(across, d, places.across + i);
    hn::Store(up, d, places.up + i);
  }
}

HWY_INLINE hn::Vec<Texel> mix(hn::Vec<Texel> a, hn::Vec<Texel> b, hn::Vec<Texel> t) {
  return hn::MulAdd(hn::Sub(b, a), t, a);
}

void look_up_lanes(const BorderedFaces& faces, const float (&turn)[3][3], std::size_t count,
                   BackgroundLookUps& look_ups) {
  Places places;
  find_places(faces.size, turn, count, look_ups, places);
  const Texel d;
  const std::size_t row = 4 * static_cast<std::size_t>(faces.size + 2);
  for (std::size_t i = 0; i < count; ++i) {
    const float* const first = faces.texels + 4 * static_cast<std::size_t>(places.texel[i]);
    const auto across = hn::Set(d, places.across[i]), up = hn::Set(d, places.up[i]);
    for (std::size_t c = 0; c < 4; c += hn::Lanes(d)) {
      const float* const texel = first + c;
      const auto below = mix(hn::Load(d, texel), hn::Load(d, texel + 4), across);
      const auto above = mix(hn::Load(d, texel + row), hn::Load(d, texel + row + 4), across);
      hn::Store(mix(below, above, up), d, look_ups.radiance[i] + c);
    }
  }
}

}  // namespace rimlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(look_up_lanes);

void look_up(const BorderedFaces& faces, const float (&turn)[3][3], std::size_t count,
             BackgroundLookUps& look_ups) noexcept {
  HWY_DYNAMIC_DISPATCH(look_up_lanes)(faces, turn, count, look_ups);
}

}  // namespace rimlight
#endif  // HWY_ONCE
