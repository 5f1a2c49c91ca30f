#include "reconstruction/dense/epipolar_seeds.h"

#include <algorithm>
#include <cmath>

namespace drupe::dense {

namespace {

constexpr int kBlock = 8;                                     ///< pixels a side, one corner each
constexpr float kLeastResponse = 4.0f;                        ///< grey levels squared a pixel squared: weaker is noise
constexpr double kMostOffLine = 2;                            ///< pixels
constexpr std::size_t kMostNeighbours = 4, kMostGuesses = 6;  ///< of a corner
constexpr int kNear = 3;                                      ///< cells around a corner that must be empty
constexpr float kNoPrior = 1e3f;                              ///< pixels of parallax: no prior

float Grey(const SampledImage& image, int x, int y) {
  return static_cast<float>(image.pairs[static_cast<std::ptrdiff_t>(y) * image.stride + x] & 0xFFFF) / 256.0f;
}

/// The smaller eigenvalue of the mean gradient tensor over 5 x 5 pixels.
float CornerResponse(const SampledImage& image, int x, int y) {
  float xx = 0, xy = 0, yy = 0;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      const float gx = 0.5f * (Grey(image, x + dx + 1, y + dy) - Grey(image, x + dx - 1, y + dy));
      const float gy = 0.5f * (Grey(image, x + dx, y + dy + 1) - Grey(image, x + dx, y + dy - 1));
      xx += gx * gx;
      xy += gx * gy;
      yy += gy * gy;
    }
  }
  const float half_difference = 0.5f * (xx - yy);
  return (0.5f * (xx + yy) - std::sqrt(half_difference * half_difference + xy * xy)) / 25;
}

/// A pair of corners that may be one point of the surface.
struct Candidate {
  double off_line = 0;
  double inverse_depth = 0;
};

/// The inverse depth at which the reference pixel projects nearest to a neighbour's corner.
Candidate Meet(const NeighbourWarp& warp, const Eigen::Vector2i& reference, const Eigen::Vector2i& corner) {
  Eigen::Vector3d a;
  for (int r = 0; r < 3; ++r)
    a[r] = warp.a[3 * r] * reference.x() + warp.a[3 * r + 1] * reference.y() + warp.a[3 * r + 2];
  const Eigen::Vector3d b(warp.b[0], warp.b[1], warp.b[2]);
  // (a + b w) x (x, y, 1) = 0 in its first two rows, linear in w.
  const Eigen::Vector2d slope(b[0] - corner.x() * b[2], b[1] - corner.y() * b[2]);
  const Eigen::Vector2d value(corner.x() * a[2] - a[0], corner.y() * a[2] - a[1]);
  const double w = slope.dot(value) / std::max(slope.squaredNorm(), 1e-12);
  const Eigen::Vector3d p = a + b * w;
  if (!(w > 0) || p.z() <= 0) return {1e9, 0};
  return {(Eigen::Vector2d(p.x() / p.z(), p.y() / p.z()) - corner.cast<double>()).norm(), w};
}

bool IsEmptyAround(const PatchMap& map, int col, int row) {
  for (int r = row - kNear; r <= row + kNear; ++r) {
    for (int c = col - kNear; c <= col + kNear; ++c) {
      if (map.Holds(c, r) && map.At(c, r).Filled()) return false;
    }
  }
  return true;
}

/// Towards the reference, and away from the region's middle where there is one.
std::vector<Eigen::Vector3d> LikelyNormals(const DenseScene& scene, int reference, const Eigen::Vector3d& position) {
  std::vector<Eigen::Vector3d> normals = {(scene.views[reference].centre - position).normalized()};
  if (scene.region.box) normals.push_back((position - scene.region.box->center()).normalized());
  return normals;
}

/// The corners of the reference's best neighbours that may show the same point, nearest to the epipolar line first.
std::vector<Candidate> FindCandidates(const LevelContext& context, int reference, const Eigen::Vector2i& corner,
                                      const std::vector<std::vector<Eigen::Vector2i>>& corners) {
  const RefinerFrame& frame = context.frames[reference];
  std::vector<Candidate> candidates;
  for (std::size_t k = 0; k < std::min(frame.neighbours.size(), kMostNeighbours); ++k) {
    for (const Eigen::Vector2i& other : corners[context.scene->neighbours[reference][k]]) {
      const Candidate candidate = Meet(frame.neighbours[k], corner, other);
      if (candidate.off_line <= kMostOffLine) candidates.push_back(candidate);
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.off_line < b.off_line; });
  return candidates;
}

/// Adds the guesses of one place; false when it lies outside the region.
bool AddGuesses(const LevelContext& context, int reference, const Eigen::Vector2i& corner, double inverse_depth,
                const PatchMap& map, std::vector<PatchGuess>* guesses) {
  const DenseScene& scene = *context.scene;
  const DenseView& view = scene.views[reference];
  const LevelCamera& camera = context.cameras[reference];
  const Eigen::Vector3d in_cam = camera.Ray(corner.x(), corner.y()) / inverse_depth;
  const Eigen::Vector3d position = view.centre + view.cam_from_world.rotation.transpose() * in_cam;
  if (!scene.region.Contains(position)) return false;
  const int col = map.CellOf(corner.x()), row = map.CellOf(corner.y());
  for (const Eigen::Vector3d& normal : LikelyNormals(scene, reference, position)) {
    PatchCell plane = FromWorld(view, camera, {position, normal});
    plane.w += static_cast<float>((map.Pixel(col) - corner.x()) * plane.wu + (map.Pixel(row) - corner.y()) * plane.wv);
    plane.sigma = kNoPrior;
    if (plane.w > 0) guesses->push_back({row * map.cols + col, plane});
  }
  return true;
}

}  // namespace

std::vector<Eigen::Vector2i> FindCorners(const SampledImage& image, int margin) {
  std::vector<Eigen::Vector2i> corners;
  const int rim = std::max(margin, 3);
  for (int y0 = rim; y0 < image.height - rim; y0 += kBlock) {
    for (int x0 = rim; x0 < image.width - rim; x0 += kBlock) {
      float best = kLeastResponse;
      Eigen::Vector2i at(-1, -1);
      for (int y = y0; y < std::min(y0 + kBlock, image.height - rim); ++y) {
        for (int x = x0; x < std::min(x0 + kBlock, image.width - rim); ++x) {
          const float response = CornerResponse(image, x, y);
          if (response <= best) continue;
          best = response;
          at = {x, y};
        }
      }
      if (at.x() >= 0) corners.push_back(at);
    }
  }
  return corners;
}

std::vector<PatchGuess> EpipolarGuesses(const LevelContext& context, int reference,
                                        const std::vector<std::vector<Eigen::Vector2i>>& corners, const PatchMap& map) {
  std::vector<PatchGuess> guesses;
  for (const Eigen::Vector2i& corner : corners[reference]) {
    const int col = map.CellOf(corner.x()), row = map.CellOf(corner.y());
    if (!map.Holds(col, row) || !IsEmptyAround(map, col, row)) continue;
    if (IsBackground(context, reference, corner.x(), corner.y())) continue;
    std::size_t used = 0;
    for (const Candidate& candidate : FindCandidates(context, reference, corner, corners)) {
      if (!AddGuesses(context, reference, corner, candidate.inverse_depth, map, &guesses)) continue;
      if (++used == kMostGuesses) break;
    }
  }
  return guesses;
}

}  // namespace drupe::dense
