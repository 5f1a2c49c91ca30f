#pragma once

#include <Eigen/Core>
#include <vector>

namespace drupe::dense {

/// One view's look at a surface point: the normal in the camera's frame and the logarithm of the colour.
struct ShadingSample {
  Eigen::Vector3f normal_in_cam = Eigen::Vector3f::Zero();
  Eigen::Array3f log_colour = Eigen::Array3f::Zero();
};

/// Diffuse shading as a function of the normal in the camera's frame. The lamps stand still with the camera while the
/// fruit turns, so one function holds for all views: the logarithm of a quadratic in the normal (nine spherical
/// harmonics, Basri & Jacobs 2003), per colour channel.
class ShadingModel {
 public:
  ShadingModel() = default;  ///< no shading

  /// The model that explains most of the samples: least squares with residuals beyond a few sigmas (spots, highlights)
  /// weighted down. Fewer than 1000 samples give no shading.
  static ShadingModel Fit(const std::vector<ShadingSample>& samples);

  /// log of the shading, 0 on the average of the samples.
  Eigen::Array3f Log(const Eigen::Vector3f& normal_in_cam) const;

 private:
  Eigen::Matrix<float, 9, 3> coefficients_ = Eigen::Matrix<float, 9, 3>::Zero();
};

}  // namespace drupe::dense
