#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/json.h"
#include "reconstruction/pipeline.h"

namespace cv {
class Mat;
}

namespace drupe {

/// For tests: the sample set as a rig gives it, and what can go wrong with it. Pictures that are not changed stay the
/// files they are.
class DamagedRig {
 public:
  DamagedRig();

  int size() const { return static_cast<int>(input_.images.size()); }
  const ReconstructionInput& input() const { return input_; }
  ReconstructionInput& input() { return input_; }

  /// Leaves the pictures for which keep(number) is true.
  void KeepOnly(const std::function<bool(int)>& keep);
  /// A copy of a picture after the others, as if the shutter had gone twice.
  void Repeat(int picture);
  /// The table turned while the shutter was open, or the lens was out of focus.
  void Blur(int picture, double sigma_px);
  /// Cloth over the half of the board with x < 0; what the fruit hides of it stays hidden.
  void CoverHalfTheBoard();
  /// A fruit whose skin shows next to nothing.
  void SmoothTheFruit(double sigma_px);

  /// The largest distance of a registered camera's centre from the truth, mm.
  double WorstCentreMm(const SparseModel& model) const;

 private:
  struct Circle;

  void Add(const std::string& name, std::string bytes);
  void Change(int picture, const std::function<void(cv::Mat&)>& edit);
  /// A circle around what the fruit can cover.
  Circle FruitIn(int picture) const;
  Eigen::Vector2d PixelOf(int picture, const Eigen::Vector3d& point) const;

  Json truth_;
  ReconstructionInput input_;
  std::vector<Rigid3> poses_;  ///< true ones, of the pictures
};

}  // namespace drupe
