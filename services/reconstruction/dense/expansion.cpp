#include "reconstruction/dense/expansion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>

namespace drupe::dense {

namespace {

constexpr int kMaxTries = 4;           ///< of a cell, from different neighbours
constexpr float kUnknownDepth = 1e3f;  ///< pixels of parallax: no prior
constexpr float kExpansionSlopeSigma = 0.1f;
constexpr float kFurthestMove = 2.0f;  ///< pixels of parallax that a patch may leave its guess

/// Collects guesses and refines them sixteen at a time.
class GuessRefiner {
 public:
  GuessRefiner(const LevelContext& context, int reference, float slope_sigma)
      : context_(context), reference_(reference), settings_(context.settings) {
    settings_.slope_sigma = slope_sigma;
  }

  bool Full() const { return batch_.count == PatchBatch::kSize; }
  bool Empty() const { return batch_.count == 0; }

  /// False when the guess cannot be tried: at the border, or too few views face it.
  bool Add(const PatchMap& map, const PatchGuess& guess) {
    const int u = map.Pixel(guess.cell % map.cols), v = map.Pixel(guess.cell / map.cols);
    const SampledImage& image = context_.frames[reference_].reference;
    const int margin = settings_.half + 1;
    if (u < margin || v < margin || u >= image.width - margin || v >= image.height - margin) return false;
    if (!(guess.plane.w > 0) || IsBackground(context_, reference_, u, v)) return false;
    const SurfaceElement element =
        ToWorld(context_.scene->views[reference_], context_.cameras[reference_], u, v, guess.plane);
    const std::uint32_t facing = FacingNeighbours(*context_.scene, reference_, element);
    if (facing == 0) return false;
    const int lane = batch_.count++;
    cells_[lane] = guess.cell;
    batch_.u[lane] = static_cast<float>(u);
    batch_.v[lane] = static_cast<float>(v);
    batch_.w[lane] = guess.plane.w;
    batch_.wu[lane] = guess.plane.wu;
    batch_.wv[lane] = guess.plane.wv;
    batch_.depth_sigma[lane] = guess.plane.sigma;
    batch_.views[lane] = facing;
    return true;
  }

  /// Refines what was added and calls accept(cell, patch) for every acceptable patch.
  template <typename Accept>
  void Flush(Accept&& accept) {
    if (Empty()) return;
    RefinePatches(context_.frames[reference_], settings_, &batch_);
    for (int lane = 0; lane < batch_.count; ++lane) {
      const PatchCell cell{batch_.w[lane],   batch_.wu[lane],    batch_.wv[lane],   0,
                           batch_.ncc[lane], batch_.sigma[lane], batch_.views[lane]};
      if (batch_.moved[lane] > kFurthestMove) continue;
      if (IsAcceptable(context_, reference_, batch_.u[lane], batch_.v[lane], cell)) accept(cells_[lane], cell);
    }
    batch_.count = 0;
  }

 private:
  const LevelContext& context_;
  int reference_;
  RefinerSettings settings_;
  PatchBatch batch_;
  std::array<int, PatchBatch::kSize> cells_{};
};

/// Unit normals to try for a seed: towards the reference, tilted to four sides of it, and away from the region's
/// middle.
std::vector<Eigen::Vector3d> SeedNormals(const DenseScene& scene, int reference, const Eigen::Vector3d& position) {
  const Eigen::Vector3d sight = (scene.views[reference].centre - position).normalized();
  const Eigen::Matrix3d& rotation = scene.views[reference].cam_from_world.rotation;
  const Eigen::Vector3d right = rotation.row(0), down = rotation.row(1);
  std::vector<Eigen::Vector3d> normals = {sight};
  for (const double tilt : {-0.7, 0.7}) {
    normals.push_back((sight + tilt * right).normalized());
    normals.push_back((sight + tilt * down).normalized());
  }
  if (scene.region.box) normals.push_back((position - scene.region.box->center()).normalized());
  return normals;
}

bool LikelyVisible(const DenseScene& scene, int reference, const Track& track) {
  const auto direction = [&](int view) { return (scene.views[view].centre - track.position).normalized(); };
  const Eigen::Vector3d sight = direction(reference);
  for (const Observation& observation : track.observations) {
    if (observation.view == scene.views[reference].index) return true;
    for (const int neighbour : scene.neighbours[reference]) {
      if (scene.views[neighbour].index == observation.view && direction(neighbour).dot(sight) > 0.93) return true;
    }
  }
  return false;
}

/// A cell from which the map grows; the best NCC first, then the lower index.
struct Front {
  float ncc;
  int cell;
  bool operator<(const Front& other) const { return ncc != other.ncc ? ncc < other.ncc : cell > other.cell; }
};

/// The empty cells beside `cell` that may be tried, with the guess that its plane gives.
class Frontier {
 public:
  explicit Frontier(const PatchMap& map) : map_(map), tries_(map.cells.size(), 0), pending_(map.cells.size(), 0) {}

  template <typename Visit>
  void VisitNeighbours(int cell, Visit&& visit) {
    constexpr std::array<std::pair<int, int>, 4> kSteps = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    const int col = cell % map_.cols, row = cell / map_.cols;
    for (const auto& [dc, dr] : kSteps) {
      if (!map_.Holds(col + dc, row + dr)) continue;
      const int next = (row + dr) * map_.cols + col + dc;
      if (map_.cells[next].Filled() || pending_[next] || tries_[next] >= kMaxTries) continue;
      ++tries_[next];
      PatchGuess guess{next, map_.cells[cell]};
      guess.plane.sigma = kUnknownDepth;
      guess.plane.w += static_cast<float>(map_.csize) * (guess.plane.wu * dc + guess.plane.wv * dr);
      pending_[next] = visit(guess) ? 1 : 0;
    }
  }
  void ClearPending(int cell) { pending_[cell] = 0; }

 private:
  const PatchMap& map_;
  std::vector<std::uint8_t> tries_, pending_;
};

}  // namespace

std::vector<PatchGuess> SeedGuesses(const LevelContext& context, int reference, const PatchMap& map) {
  const DenseScene& scene = *context.scene;
  std::vector<PatchGuess> guesses;
  for (const Track& track : scene.model->tracks) {
    if (!scene.region.Contains(track.position) || !LikelyVisible(scene, reference, track)) continue;
    const Eigen::Vector3d in_cam = scene.views[reference].cam_from_world * track.position;
    if (in_cam.z() <= 0) continue;
    const Eigen::Vector2d pixel = context.cameras[reference].Pixel(in_cam);
    const int col = map.CellOf(pixel.x()), row = map.CellOf(pixel.y());
    if (!map.Holds(col, row)) continue;
    for (const Eigen::Vector3d& normal : SeedNormals(scene, reference, track.position)) {
      PatchCell plane = FromWorld(scene.views[reference], context.cameras[reference], {track.position, normal});
      plane.w += static_cast<float>((map.Pixel(col) - pixel.x()) * plane.wu + (map.Pixel(row) - pixel.y()) * plane.wv);
      plane.sigma = kUnknownDepth;
      if (plane.w > 0) guesses.push_back({row * map.cols + col, plane});
    }
  }
  return guesses;
}

void PlaceGuesses(const LevelContext& context, int reference, const std::vector<PatchGuess>& guesses, float slope_sigma,
                  const std::function<bool()>& cancelled, PatchMap* map) {
  GuessRefiner refiner(context, reference, slope_sigma);
  const auto keep_best = [map](int cell, const PatchCell& patch) {
    if (patch.ncc > map->cells[cell].ncc) map->cells[cell] = patch;
  };
  for (const PatchGuess& guess : guesses) {
    refiner.Add(*map, guess);
    if (!refiner.Full()) continue;
    if (cancelled && cancelled()) return;
    refiner.Flush(keep_best);
  }
  refiner.Flush(keep_best);
}

void KeepGuesses(const std::vector<PatchGuess>& guesses, PatchMap* map) {
  for (const PatchGuess& guess : guesses) {
    if (!map->cells[guess.cell].Filled()) map->cells[guess.cell] = guess.plane;
  }
}

void Expand(const LevelContext& context, int reference, const std::function<bool()>& cancelled, PatchMap* map) {
  GuessRefiner refiner(context, reference, kExpansionSlopeSigma);
  Frontier frontier(*map);
  std::priority_queue<Front> front;
  for (std::size_t i = 0; i < map->cells.size(); ++i) {
    if (map->cells[i].Filled()) front.push({map->cells[i].ncc, static_cast<int>(i)});
  }
  std::vector<int> tried;
  const auto flush = [&] {
    refiner.Flush([&](int cell, const PatchCell& patch) {
      map->cells[cell] = patch;
      front.push({patch.ncc, cell});
    });
    for (const int cell : tried) frontier.ClearPending(cell);
    tried.clear();
  };
  while (!cancelled || !cancelled()) {
    while (!front.empty() && !refiner.Full()) {
      const int cell = front.top().cell;
      front.pop();
      frontier.VisitNeighbours(cell, [&](const PatchGuess& guess) {
        if (refiner.Full()) flush();
        if (!refiner.Add(*map, guess)) return false;
        tried.push_back(guess.cell);
        return true;
      });
    }
    if (refiner.Empty()) return;
    flush();
  }
}

}  // namespace drupe::dense
