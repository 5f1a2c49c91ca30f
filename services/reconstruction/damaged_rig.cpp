#include "reconstruction/damaged_rig.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "base/files.h"

namespace drupe {
namespace {

Json LoadJson(const std::string& path) {
  return ParseJson(ReadFile(path).value()).value();
}

Rigid3 PoseOf(const Json& view) {
  Rigid3 pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.rotation(row, column) = view["R"][row][column];
    pose.translation[row] = view["t"][row];
  }
  return pose;
}

cv::Point Rounded(const Eigen::Vector2d& pixel) {
  return {static_cast<int>(pixel.x()), static_cast<int>(pixel.y())};
}

}  // namespace

struct DamagedRig::Circle {
  Eigen::Vector2d centre;
  double radius;
};

DamagedRig::DamagedRig() {
  const std::string directory = std::string(DRUPE_TEST_DATA) + "/plum-s";
  truth_ = LoadJson(directory + "/truth.json");
  input_.calibration = ParseCalibration(LoadJson(directory + "/calibration.json")).value();
  input_.board = ParseBoard(LoadJson(directory + "/board.json")).value();
  for (const Json& view : truth_["views"]) {
    const std::string name = view["image"];
    Add(name, ReadFile(directory + "/images/" + name).value());
    poses_.push_back(PoseOf(view));
  }
}

void DamagedRig::KeepOnly(const std::function<bool(int)>& keep) {
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

void DamagedRig::Repeat(int picture) {
  Add("again-" + input_.images[picture].name, input_.images[picture].read().value());
  poses_.push_back(poses_[picture]);
}

void DamagedRig::Blur(int picture, double sigma_px) {
  Change(picture, [sigma_px](cv::Mat& image) { cv::GaussianBlur(image, image, {}, sigma_px); });
}

void DamagedRig::CoverHalfTheBoard() {
  const auto cover = [this](int picture, cv::Mat& image) {
    const Circle fruit = FruitIn(picture);
    for (const auto& [id, corners] : input_.board->corners_mm) {
      std::vector<cv::Point> outline;
      for (const Eigen::Vector3d& corner : corners) outline.push_back(Rounded(PixelOf(picture, corner)));
      const bool is_hidden = (PixelOf(picture, corners[0]) - fruit.centre).norm() < fruit.radius;
      if (corners[0].x() > 0 || is_hidden) continue;
      cv::fillConvexPoly(image, outline, cv::Scalar(90, 90, 90), cv::LINE_AA);
    }
  };
  for (int i = 0; i < size(); ++i) Change(i, [&](cv::Mat& image) { cover(i, image); });
}

void DamagedRig::SmoothTheFruit(double sigma_px) {
  const auto smooth_fruit = [this, sigma_px](int picture, cv::Mat& image) {
    cv::Mat smooth, mask = cv::Mat::zeros(image.size(), CV_8U);
    cv::GaussianBlur(image, smooth, {}, sigma_px);
    const Circle fruit = FruitIn(picture);
    cv::circle(mask, Rounded(fruit.centre), static_cast<int>(fruit.radius), cv::Scalar(255), cv::FILLED);
    smooth.copyTo(image, mask);
  };
  for (int i = 0; i < size(); ++i) Change(i, [&](cv::Mat& image) { smooth_fruit(i, image); });
}

double DamagedRig::WorstCentreMm(const SparseModel& model) const {
  double worst = 0;
  for (std::size_t i = 0; i < model.views.size(); ++i) {
    if (!model.views[i].cam_from_world) continue;
    worst = std::max(worst, (model.views[i].cam_from_world->Centre() - poses_[i].Centre()).norm());
  }
  return worst;
}

void DamagedRig::Add(const std::string& name, std::string bytes) {
  input_.images.push_back({name, [bytes = std::move(bytes)]() -> Result<std::string> { return bytes; }});
}

void DamagedRig::Change(int picture, const std::function<void(cv::Mat&)>& edit) {
  const std::string bytes = input_.images[picture].read().value();
  cv::Mat image = cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_COLOR);
  edit(image);
  std::vector<unsigned char> encoded;
  cv::imencode(".jpg", image, encoded, {cv::IMWRITE_JPEG_QUALITY, 95});
  const std::string changed(encoded.begin(), encoded.end());
  input_.images[picture].read = [changed]() -> Result<std::string> { return changed; };
}

DamagedRig::Circle DamagedRig::FruitIn(int picture) const {
  constexpr double kFruitRadiusMm = 21;
  const Json& centre = truth_["centre_mm"];
  const Eigen::Vector3d middle(centre[0], centre[1], centre[2]);
  const double depth = (poses_[picture] * middle).z();
  return {PixelOf(picture, middle), kFruitRadiusMm * input_.calibration->camera.fx / depth};
}

/// Every point of the table lies in front of the cameras.
Eigen::Vector2d DamagedRig::PixelOf(int picture, const Eigen::Vector3d& point) const {
  return input_.calibration->camera.Project(poses_[picture] * point).value();
}

}  // namespace drupe
