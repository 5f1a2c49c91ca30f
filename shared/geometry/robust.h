#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace drupe {

/// The middle value (of an even number, the upper of the two); 0 for none. Takes a copy, since it reorders.
template <typename T>
T Median(std::vector<T> values) {
  if (values.empty()) return T{0};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Robust standard deviation about zero: 1.4826 times the median of the absolute values.
template <typename T>
T RobustSigma(std::vector<T> residuals) {
  for (T& r : residuals) r = std::abs(r);
  return static_cast<T>(1.4826) * Median(std::move(residuals));
}

/// Tukey's biweight of a residual in standard deviations: 1 at 0, 0 from 4.685 on (95 % efficiency).
inline double TukeyWeight(double residual) {
  const double t = residual / 4.685;
  const double s = 1 - t * t;
  return s > 0 ? s * s : 0.0;
}

}  // namespace drupe
