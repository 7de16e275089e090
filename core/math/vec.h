#pragma once

#include <cmath>

namespace rimlight {

/// Three numbers: a point, a direction, or linear RGB. World space is right-handed with y up.
template <typename T>
struct Vec3 {
  T x{}, y{}, z{};

  constexpr Vec3() = default;
  constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  template <typename U>
  constexpr explicit Vec3(const Vec3<U>& other)
      : x(static_cast<T>(other.x)), y(static_cast<T>(other.y)), z(static_cast<T>(other.z)) {}
  static constexpr Vec3 filled(T value) { return {value, value, value}; }

  constexpr T operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  constexpr T& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }

  constexpr Vec3 operator-() const { return {-x, -y, -z}; }
  constexpr Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  constexpr Vec3& operator-=(const Vec3& b) { return *this = *this - b; }
  constexpr Vec3& operator*=(const Vec3& b) { return *this = *this * b; }
  constexpr Vec3& operator*=(T s) { return *this = *this * s; }

  friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr Vec3 operator*(const Vec3& a, const Vec3& b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
  }
  friend constexpr Vec3 operator*(const Vec3& a, T s) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr Vec3 operator*(T s, const Vec3& a) { return a * s; }
  friend constexpr Vec3 operator/(const Vec3& a, T s) { return {a.x / s, a.y / s, a.z / s}; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <typename T>
constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <typename T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <typename T>
T length(const Vec3<T>& a) {
  return std::sqrt(dot(a, a));
}

/// a / |a|; a must not be zero.
template <typename T>
Vec3<T> normalized(const Vec3<T>& a) {
  return a / length(a);
}

template <typename T>
constexpr T max_component(const Vec3<T>& a) {
  const T xy = a.x > a.y ? a.x : a.y;
  return xy > a.z ? xy : a.z;
}

template <typename T>
bool is_finite(const Vec3<T>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Two unit vectors that complete a unit `normal` to a right-handed frame (tangent, bitangent,
/// normal). Continuous but at one pole (Duff et al. 2017, JCGT 6(1)).
template <typename T>
struct Frame {
  Vec3<T> tangent, bitangent, normal;

  explicit Frame(const Vec3<T>& n) : normal(n) {
    const T sign = std::copysign(T(1), n.z);
    const T a = T(-1) / (sign + n.z);
    const T b = n.x * n.y * a;
    tangent = {T(1) + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
  }

  /// With the tangent as near to `along` (any length) as the normal allows; where they are
  /// parallel, or `along` is zero, the frame of the normal alone.
  Frame(const Vec3<T>& n, const Vec3<T>& along) : Frame(n) {
    const Vec3<T> flat = along - n * dot(n, along);
    const T squared = dot(flat, flat);
    if (!(squared > T(1e-10) * dot(along, along))) return;
    tangent = flat / std::sqrt(squared);
    bitangent = cross(n, tangent);
  }

  Vec3<T> to_world(const Vec3<T>& v) const {
    return tangent * v.x + bitangent * v.y + normal * v.z;
  }
  Vec3<T> to_local(const Vec3<T>& v) const {
    return {dot(v, tangent), dot(v, bitangent), dot(v, normal)};
  }
};

}  // namespace rimlight
