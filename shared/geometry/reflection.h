#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace drupe {

/// Householder's reflection x -> x - v (v . x), |v|^2 = 2, that turns a given vector onto its first axis; the identity
/// when it lies there. For small solvers: plain loops, since Eigen's own reflections take seconds to compile a size.
class Reflection {
 public:
  static constexpr int kMaxSize = 10;

  /// `size`: 1..kMaxSize.
  Reflection(const double* vector, int size) : size_(size) {
    double tail = 0;
    for (int i = 1; i < size; ++i) tail += vector[i] * vector[i];
    if (!(tail > 0)) return;
    const double squared = vector[0] * vector[0] + tail, norm = std::sqrt(squared);
    const double scale = 1 / std::sqrt(squared + std::abs(vector[0]) * norm);
    for (int i = 0; i < size; ++i) v_[i] = scale * vector[i];
    v_[0] += scale * std::copysign(norm, vector[0]);
  }

  /// Of the vector x[0], x[stride], ...
  void Apply(double* x, std::ptrdiff_t stride = 1) const {
    double dot = 0;
    for (int i = 0; i < size_; ++i) dot += v_[i] * x[i * stride];
    for (int i = 0; i < size_; ++i) x[i * stride] -= dot * v_[i];
  }

 private:
  int size_;
  std::array<double, kMaxSize> v_{};
};

}  // namespace drupe
