#pragma once

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/files.h"
#include "base/json.h"
#include "reconstruction/pipeline.h"

namespace drupe {

/// For tests: the sample set as a rig gives it, and what can go wrong with it. Pictures are changed with OpenCV; those
/// that are not changed stay the files they are.
class DamagedRig {
 public:
  DamagedRig() {
    const std::string directory = std::string(DRUPE_TEST_DATA) + "/plum-s";
    truth_ = ParseJson(ReadFile(directory + "/truth.json").value()).value();
    input_.calibration = ParseCalibration(ParseJson(ReadFile(directory + "/calibration.json").value()).value()).value();
    input_.board = ParseBoard(ParseJson(ReadFile(directory + "/board.json").value()).value()).value();
    for (const Json& view : truth_["views"]) {
      const std::string name = view["image"];
      Add(name, ReadFile(directory + "/images/" + name).value());
      poses_.push_back(PoseOf(view));
    }
  }

  int size() const { return static_cast<int>(input_.images.size()); }
  const ReconstructionInput& input() const { return input_; }
  ReconstructionInput& input() { return input_; }
  const Rigid3& TruePose(int picture) const { return poses_[picture]; }

  /// Leaves the pictures for which keep(number) is true.
  template <typename Keep>
  void KeepOnly(const Keep& keep) {
    std::vector<SourceImage> images;
    std::vector<Rigid3> poses;
    for (int i = 0; i < size(); ++i) {
      if (!keep(i)) continue;
      images.push_back(input_.images[i]);
      poses.push_back(poses_[i]);
    }
    input_.images = std::move(images);
    poses_ = std::move(poses);
  }

  /// A copy of a picture after the others, as if the shutter had gone twice.
  void Repeat(int picture) {
    Add("again-" + input_.images[picture].name, input_.images[picture].read().value());
    poses_.push_back(poses_[picture]);
  }

  /// The table turned while the shutter was open, or the lens was out of focus.
  void Blur(int picture, double sigma_px) {
    Change(picture, [sigma_px](cv::Mat& image) { cv::GaussianBlur(image, image, {}, sigma_px); });
  }

  /// Cloth over the half of the board with x < 0; what the fruit hides of it stays hidden.
  void CoverHalfTheBoard() {
    ForEach([this](int picture, cv::Mat& image) {
      const Circle fruit = FruitIn(picture);
      for (const auto& [id, corners] : input_.board->corners_mm) {
        const std::vector<cv::Point> outline = OutlineOf(picture, corners);
        if (corners[0].x() > 0 || outline.empty() || cv::norm(outline[0] - fruit.centre) < fruit.radius) continue;
        cv::fillConvexPoly(image, outline, cv::Scalar(90, 90, 90), cv::LINE_AA);
      }
    });
  }

  /// A fruit whose skin shows next to nothing.
  void SmoothTheFruit(double sigma_px) {
    ForEach([this, sigma_px](int picture, cv::Mat& image) {
      cv::Mat smooth, mask = cv::Mat::zeros(image.size(), CV_8U);
      cv::GaussianBlur(image, smooth, {}, sigma_px);
      const Circle fruit = FruitIn(picture);
      cv::circle(mask, fruit.centre, static_cast<int>(fruit.radius), cv::Scalar(255), cv::FILLED);
      smooth.copyTo(image, mask);
    });
  }

  /// The largest distance of a registered camera's centre from the truth, mm.
  double WorstCentreMm(const SparseModel& model) const {
    double worst = 0;
    for (std::size_t i = 0; i < model.views.size(); ++i) {
      if (!model.views[i].cam_from_world) continue;
      worst = std::max(worst, (model.views[i].cam_from_world->Centre() - poses_[i].Centre()).norm());
    }
    return worst;
  }

 private:
  struct Circle {
    cv::Point centre;
    double radius;
  };

  static Rigid3 PoseOf(const Json& view) {
    Rigid3 pose;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) pose.rotation(row, column) = view["R"][row][column];
      pose.translation[row] = view["t"][row];
    }
    return pose;
  }

  void Add(const std::string& name, std::string bytes) {
    input_.images.push_back({name, [bytes = std::move(bytes)]() -> Result<std::string> { return bytes; }});
  }

  template <typename Edit>
  void Change(int picture, const Edit& edit) {
    const std::string bytes = input_.images[picture].read().value();
    cv::Mat image = cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_COLOR);
    edit(image);
    std::vector<unsigned char> encoded;
    cv::imencode(".jpg", image, encoded, {cv::IMWRITE_JPEG_QUALITY, 95});
    input_.images[picture].read = [changed = std::string(encoded.begin(), encoded.end())]() -> Result<std::string> {
      return changed;
    };
  }

  template <typename Edit>
  void ForEach(const Edit& edit) {
    for (int i = 0; i < size(); ++i) {
      Change(i, [&](cv::Mat& image) { edit(i, image); });
    }
  }

  cv::Point PixelOf(int picture, const Eigen::Vector3d& point) const {
    const auto pixel = input_.calibration->camera.Project(poses_[picture] * point);
    return pixel ? cv::Point(static_cast<int>(pixel->x()), static_cast<int>(pixel->y())) : cv::Point(-10'000, -10'000);
  }

  std::vector<cv::Point> OutlineOf(int picture, const std::array<Eigen::Vector3d, 4>& corners) const {
    std::vector<cv::Point> outline;
    for (const Eigen::Vector3d& corner : corners) outline.push_back(PixelOf(picture, corner));
    return outline;
  }

  /// A circle around what the fruit can cover.
  Circle FruitIn(int picture) const {
    constexpr double kFruitRadiusMm = 21;
    const Json& centre = truth_["centre_mm"];
    const Eigen::Vector3d middle(centre[0], centre[1], centre[2]);
    const double depth = (poses_[picture] * middle).z();
    return {PixelOf(picture, middle), kFruitRadiusMm * input_.calibration->camera.fx / depth};
  }

  Json truth_;
  ReconstructionInput input_;
  std::vector<Rigid3> poses_;  ///< true ones, of the pictures
};

}  // namespace drupe
