#include "reconstruction/dense/patch_refiner.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "reconstruction/dense/patch_map.h"
#include "reconstruction/dense/synthetic_scene.h"

namespace drupe::dense {
namespace {

constexpr double kDistance = 100;

/// A tilted textured plane before three cameras that stand 12 apart.
struct PlaneScene {
  Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, -1).normalized();
  std::vector<DenseView> views;
  RefinerFrame frame;

  PlaneScene() {
    SparseModel model;
    model.camera = {160, 120, 300, 300, 79.5, 59.5, {}};
    for (const double x : {0.0, 12.0, -12.0}) {
      View view;
      view.cam_from_world = Rigid3{Eigen::Matrix3d::Identity(), Eigen::Vector3d(-x, -0.3 * x, 0)};
      model.views.push_back(view);
    }
    const Eigen::Vector3d through(0, 0, kDistance);
    const auto pictures = Render(model, [&](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
      return std::optional<Eigen::Vector3d>(origin +
                                            direction * (normal.dot(through - origin) / normal.dot(direction)));
    });
    views.resize(pictures.size());
    for (std::size_t i = 0; i < views.size(); ++i) {
      views[i].cam_from_world = *model.views[i].cam_from_world;
      views[i].centre = views[i].cam_from_world.Centre();
      BuildPyramid(pictures[i], model.camera, {0, 0, 160, 120}, 1, &views[i]);
    }
    frame = MakeRefinerFrame(views, 0, {1, 2}, 0, kDistance);
  }

  /// The true plane at a pixel of the reference.
  PatchCell Truth(double u, double v) const {
    const LevelCamera camera = views[0].CameraAt(0);
    const Eigen::Vector3d ray = camera.Ray(u, v);
    return FromWorld(views[0], camera, {ray * (normal.z() * kDistance / normal.dot(ray)), normal});
  }
};

const PlaneScene& Scene() {
  static const PlaneScene scene;
  return scene;
}

double GreyAt(const SampledImage& image, double x, double y) {
  const auto pixel = [&](int column, int row) { return (image.pairs[row * image.stride + column] & 0xFFFF) / 256.0; };
  const int xi = static_cast<int>(x), yi = static_cast<int>(y);
  const double fx = x - xi, fy = y - yi;
  const double upper = pixel(xi, yi) + fx * (pixel(xi + 1, yi) - pixel(xi, yi));
  const double lower = pixel(xi, yi + 1) + fx * (pixel(xi + 1, yi + 1) - pixel(xi, yi + 1));
  return upper + fy * (lower - upper);
}

/// The same fit written down plainly: one patch, double precision, dense matrices.
class PlainRefiner {
 public:
  PlainRefiner(const RefinerFrame& frame, const RefinerSettings& settings, int u, int v)
      : frame_(frame), settings_(settings), u_(u), v_(v), reference_(Samples()), gx_(Samples()), gy_(Samples()) {
    nuisance_.resize(Samples(), 3);
    ForEachSample([&](int row, int du, int dv) {
      const SampledImage& image = frame_.reference;
      reference_[row] = GreyAt(image, u_ + du, v_ + dv);
      gx_[row] = 0.5 * (GreyAt(image, u_ + du + 1, v_ + dv) - GreyAt(image, u_ + du - 1, v_ + dv));
      gy_[row] = 0.5 * (GreyAt(image, u_ + du, v_ + dv + 1) - GreyAt(image, u_ + du, v_ + dv - 1));
      nuisance_.row(row) << 1, du, dv;
    });
    reference_ = Without(nuisance_, reference_);
  }

  Eigen::Vector3d Refine(Eigen::Vector3d plane, double depth_sigma) const {
    const Eigen::Vector3d guess = plane;
    const Eigen::Vector3d prior(1 / std::pow(depth_sigma, 2), 1 / std::pow(settings_.slope_sigma, 2),
                                1 / std::pow(settings_.slope_sigma, 2));
    for (int iteration = 0; iteration < settings_.iterations; ++iteration) {
      Eigen::Matrix3d normal = prior.asDiagonal();
      Eigen::Vector3d right = prior.cwiseProduct((plane - guess) / frame_.unit);
      for (const NeighbourWarp& warp : frame_.neighbours) AddNeighbour(warp, plane, &normal, &right);
      const Eigen::Vector3d step = normal.ldlt().solve(right);
      plane[0] -= frame_.unit * std::clamp(step[0], -1.0, 1.0);
      plane[1] -= frame_.unit * std::clamp(step[1], -0.2, 0.2);
      plane[2] -= frame_.unit * std::clamp(step[2], -0.2, 0.2);
      if (std::abs(step[0]) <= 0.01) break;
    }
    return plane;
  }

  double Ncc(const NeighbourWarp& warp, const Eigen::Vector3d& plane) const {
    const Eigen::VectorXd samples = Without(nuisance_, Sample(warp, plane));
    return samples.dot(reference_) / (samples.norm() * reference_.norm());
  }

 private:
  int Samples() const { return (2 * settings_.half + 1) * (2 * settings_.half + 1); }

  template <typename Visit>
  void ForEachSample(Visit&& visit) const {
    int row = 0;
    for (int dv = -settings_.half; dv <= settings_.half; ++dv) {
      for (int du = -settings_.half; du <= settings_.half; ++du) visit(row++, du, dv);
    }
  }

  /// The part of the columns that no combination of `basis` explains.
  static Eigen::MatrixXd Without(const Eigen::MatrixXd& basis, const Eigen::MatrixXd& columns) {
    return columns - basis * basis.householderQr().solve(columns);
  }

  static Eigen::Vector2d Project(const NeighbourWarp& warp, double u, double v, double w) {
    Eigen::Vector3d p;
    for (int r = 0; r < 3; ++r) p[r] = warp.a[3 * r] * u + warp.a[3 * r + 1] * v + warp.a[3 * r + 2] + warp.b[r] * w;
    return p.hnormalized();
  }

  Eigen::VectorXd Sample(const NeighbourWarp& warp, const Eigen::Vector3d& plane) const {
    Eigen::VectorXd samples(Samples());
    ForEachSample([&](int row, int du, int dv) {
      const Eigen::Vector2d at = Project(warp, u_ + du, v_ + dv, plane[0] + plane[1] * du + plane[2] * dv);
      samples[row] = GreyAt(warp.image, at.x(), at.y());
    });
    return samples;
  }

  void AddNeighbour(const NeighbourWarp& warp, const Eigen::Vector3d& plane, Eigen::Matrix3d* normal,
                    Eigen::Vector3d* right) const {
    // Derivatives of the projection by finite differences.
    constexpr double kStep = 1e-4;
    const auto at = [&](double du, double dv, double dw) {
      return Project(warp, u_ + du, v_ + dv, plane[0] + plane[1] * du + plane[2] * dv + dw * frame_.unit);
    };
    Eigen::Matrix2d shape;
    shape.col(0) = (at(kStep, 0, 0) - at(-kStep, 0, 0)) / (2 * kStep);
    shape.col(1) = (at(0, kStep, 0) - at(0, -kStep, 0)) / (2 * kStep);
    const Eigen::Vector2d shift = shape.inverse() * (at(0, 0, kStep) - at(0, 0, -kStep)) / (2 * kStep);
    Eigen::MatrixXd jacobian(Samples(), 3), nuisance(Samples(), 4);
    jacobian = (gx_ * shift.x() + gy_ * shift.y()).asDiagonal() * nuisance_;
    nuisance << nuisance_, reference_;
    jacobian = Without(nuisance, jacobian);
    const Eigen::VectorXd samples = Sample(warp, plane);
    const double ncc = Ncc(warp, plane), gain = samples.dot(reference_) / reference_.squaredNorm();
    const double variance = reference_.squaredNorm() / Samples() * (1 - ncc * ncc) / (ncc * ncc) + 0.25;
    *normal += jacobian.transpose() * jacobian / variance;
    *right += jacobian.transpose() * samples / (gain * variance);
  }

  const RefinerFrame& frame_;
  RefinerSettings settings_;
  int u_, v_;
  Eigen::VectorXd reference_, gx_, gy_;
  Eigen::MatrixXd nuisance_;  ///< columns 1, du, dv
};

/// A batch of patches on a grid of pixels, `off` pixels of parallax beside the truth.
PatchBatch MakeBatch(int count, float off) {
  PatchBatch batch;
  batch.count = count;
  for (int lane = 0; lane < count; ++lane) {
    const int u = 50 + 13 * (lane % 4), v = 40 + 11 * (lane / 4);
    const PatchCell truth = Scene().Truth(u, v);
    batch.u[lane] = static_cast<float>(u);
    batch.v[lane] = static_cast<float>(v);
    batch.w[lane] = truth.w + off * Scene().frame.unit;
    batch.wu[lane] = truth.wu;
    batch.wv[lane] = truth.wv;
    batch.views[lane] = 3;
    batch.depth_sigma[lane] = 10;
  }
  return batch;
}

TEST(PatchRefinerTest, AgreesWithThePlainReference) {
  const RefinerSettings settings;
  const RefinerFrame& frame = Scene().frame;
  const PatchBatch before = MakeBatch(16, 0.4f);
  PatchBatch after = before;
  RefinePatches(frame, settings, &after);
  for (int lane = 0; lane < after.count; ++lane) {
    const PlainRefiner plain(frame, settings, static_cast<int>(before.u[lane]), static_cast<int>(before.v[lane]));
    const Eigen::Vector3d expected =
        plain.Refine({before.w[lane], before.wu[lane], before.wv[lane]}, before.depth_sigma[lane]);
    EXPECT_NEAR(after.w[lane] / frame.unit, expected[0] / frame.unit, 5e-3) << lane;
    EXPECT_NEAR(after.wu[lane] / frame.unit, expected[1] / frame.unit, 5e-3) << lane;
    EXPECT_NEAR(after.wv[lane] / frame.unit, expected[2] / frame.unit, 5e-3) << lane;
    const double ncc = 0.5 * (plain.Ncc(frame.neighbours[0], expected) + plain.Ncc(frame.neighbours[1], expected));
    EXPECT_NEAR(after.ncc[lane], ncc, 1e-2) << lane;
    EXPECT_EQ(after.views[lane], 3u);
  }
}

TEST(PatchRefinerTest, FindsTheTruePlane) {
  PatchBatch batch = MakeBatch(16, -0.5f);
  RefinePatches(Scene().frame, RefinerSettings(), &batch);
  for (int lane = 0; lane < batch.count; ++lane) {
    const PatchCell truth = Scene().Truth(batch.u[lane], batch.v[lane]);
    EXPECT_NEAR(batch.w[lane] / Scene().frame.unit, truth.w / Scene().frame.unit, 0.05) << lane;
    EXPECT_GT(batch.ncc[lane], 0.9f);
    EXPECT_LT(batch.sigma[lane], 0.2f);
  }
}

TEST(PatchRefinerTest, APatchDoesNotDependOnItsBatch) {
  PatchBatch many = MakeBatch(16, 0.3f), one = MakeBatch(1, 0.3f);
  RefinePatches(Scene().frame, RefinerSettings(), &many);
  RefinePatches(Scene().frame, RefinerSettings(), &one);
  EXPECT_EQ(many.w[0], one.w[0]);
  EXPECT_EQ(many.ncc[0], one.ncc[0]);
  EXPECT_EQ(many.sigma[0], one.sigma[0]);
}

TEST(PatchRefinerTest, DropsNeighboursThatDoNotSeeThePatch) {
  PatchBatch batch = MakeBatch(1, 0);
  batch.views[0] = 2;
  RefinePatches(Scene().frame, RefinerSettings(), &batch);
  EXPECT_EQ(batch.views[0], 2u);
  RefinerFrame blind = Scene().frame;
  for (NeighbourWarp& warp : blind.neighbours) warp.a[2] += 1e4f;  // far outside the picture
  batch = MakeBatch(1, 0);
  RefinePatches(blind, RefinerSettings(), &batch);
  EXPECT_EQ(batch.views[0], 0u);
  EXPECT_EQ(batch.ncc[0], 0.0f);
}

TEST(PatchMapTest, PlanesSurviveTheWayThroughTheWorld) {
  const PatchCell truth = Scene().Truth(60, 50);
  const DenseView& view = Scene().views[0];
  const SurfaceElement element = ToWorld(view, view.CameraAt(0), 60, 50, truth);
  EXPECT_LT((element.normal - Scene().normal).norm(), 1e-5);
  const PatchCell back = FromWorld(view, view.CameraAt(0), element);
  EXPECT_NEAR(back.w, truth.w, 1e-7);
  EXPECT_NEAR(back.wu, truth.wu, 1e-9);
  EXPECT_NEAR(back.wv, truth.wv, 1e-9);
}

}  // namespace
}  // namespace drupe::dense
