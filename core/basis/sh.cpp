#include "core/basis/sh.h"

#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/basis/sh_recurrence.h"

namespace rimlight::sh {
namespace {

Recurrence make_recurrence() {
  Recurrence made;
  std::size_t next = 0;
  double square = 1 / (4 * std::numbers::pi);  // of Q_m^m, but for the factor 2 of m > 0
  for (int m = 0; m <= kLargestLightDegree; ++m) {
    if (m > 0) square *= (2.0 * m + 1) / (2.0 * m);
    made.first[static_cast<std::size_t>(m)] = std::sqrt(m == 0 ? square : 2 * square);
    for (int l = m + 1; l <= kLargestLightDegree; ++l) {
      const double across = (l - m) * (l + m);
      const double a = std::sqrt((4.0 * l * l - 1) / across);
      const double b =
          l == m + 1
              ? 0
              : std::sqrt((2.0 * l + 1) * (l - 1 - m) * (l - 1 + m) / ((2.0 * l - 3) * across));
      made.steps[next++] = {a, b};
    }
  }
  return made;
}

}  // namespace

const Recurrence& recurrence() {
  static const Recurrence kRecurrence = make_recurrence();
  return kRecurrence;
}

void check_degree(int degree) {
  RIMLIGHT_CHECK(degree >= 0);
  RIMLIGHT_CHECK(degree <= kLargestLightDegree);
}

int degree_of_count(std::size_t count) {
  RIMLIGHT_CHECK(count >= 1);
  RIMLIGHT_CHECK(count <= coefficient_count(kLargestLightDegree));
  const int degree = degree_of(count - 1);
  RIMLIGHT_CHECK_EQ(coefficient_count(degree), count);
  return degree;
}

void evaluate(const Vec3d& direction, int degree, std::span<double> values) {
  check_degree(degree);
  RIMLIGHT_CHECK_EQ(values.size(), coefficient_count(degree));
  const Vec3d d = normalized(direction);
  const Recurrence& table = recurrence();
  double cosine = 1, sine = 0;  // (x + iy)^m
  for (int m = 0; m <= degree; ++m) {
    const RecurrenceStep* step = table.steps_of(m);
    double q = table.first[static_cast<std::size_t>(m)], before = 0;
    for (int l = m; l <= degree; ++l) {
      values[index(l, m)] = q * cosine;
      if (m > 0) values[index(l, -m)] = q * sine;
      if (l == degree) break;
      const double next = step->a * d.z * q - step->b * before;
      before = q;
      q = next;
      ++step;
    }
    const double turned = cosine * d.x - sine * d.y;
    sine = cosine * d.y + sine * d.x;
    cosine = turned;
  }
}

std::vector<double> evaluate(const Vec3d& direction, int degree) {
  check_degree(degree);
  std::vector<double> values(coefficient_count(degree));
  evaluate(direction, degree, values);
  return values;
}

std::vector<double> legendre(double cosine, int degree) {
  check_degree(degree);
  std::vector<double> values(static_cast<std::size_t>(degree) + 1);
  double value = 1, before = 0;
  for (int l = 0; l <= degree; ++l) {
    values[static_cast<std::size_t>(l)] = value;
    const double next = ((2 * l + 1) * cosine * value - l * before) / (l + 1);
    before = value;
    value = next;
  }
  return values;
}

std::vector<double> band_energies(std::span<const float> coefficients) {
  const int degree = degree_of_count(coefficients.size());
  std::vector<double> energies;
  for (int l = 0; l <= degree; ++l) {
    double sum = 0;
    for (int m = -l; m <= l; ++m) {
      const auto value = static_cast<double>(coefficients[index(l, m)]);
      sum += value * value;
    }
    energies.push_back(sum);
  }
  return energies;
}

}  // namespace rimlight::sh
