#include "reconstruction/dense/background.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "image/colour.h"

namespace drupe::dense {

namespace {

constexpr int kBits = 5, kSide = 1 << kBits;     ///< of the table of sRGB colours
constexpr int kLightnesses = 16, kChromas = 32;  ///< cells of the Lab histogram
constexpr int kLabCells = kLightnesses * kChromas * kChromas;
constexpr float kLikelier = 4;            ///< background is so much more frequent at the rim than on tracks
constexpr float kLeastFrequency = 1e-4f;  ///< rarer colours tell nothing
constexpr double kMostLostTracks = 0.12;  ///< share of track pixels that may have a background colour
constexpr double kLeastRim = 0.6;         ///< share of the rim that must have one
constexpr std::size_t kLeastSamples = 200;
constexpr int kBlocksAcross = 128;   ///< of a silhouette, at least
constexpr double kFullBlock = 0.95;  ///< share of a background block's samples
constexpr int kViewsAsked = 12;
constexpr int kLeastOutside = 2;  ///< views that must place a point outside, and the share of them
constexpr double kLeastOutsideShare = 0.15;

int LabCell(const Rgb8& colour) {
  const Eigen::Vector3f lab = LabFromSrgb(colour);
  const auto cell = [](float value, float low, float width, int count) {
    return std::clamp(static_cast<int>((value - low) / width), 0, count - 1);
  };
  const int l = cell(lab[0], 0, 100.0f / kLightnesses, kLightnesses);
  const int a = cell(lab[1], -128, 256.0f / kChromas, kChromas), b = cell(lab[2], -128, 256.0f / kChromas, kChromas);
  return (l * kChromas + a) * kChromas + b;
}

Rgb8 ColourAt(const RgbImage& image, int x, int y) {
  const std::uint8_t* pixel = image.Row(y) + 3 * x;
  return {pixel[0], pixel[1], pixel[2]};
}

/// Frequencies of Lab cells.
class LabHistogram {
 public:
  void Add(const Rgb8& colour) {
    ++counts_[LabCell(colour)];
    ++total_;
  }
  std::size_t Samples() const { return total_; }

  /// Spread to the six adjacent cells, since neighbouring colours belong together; sums to 1.
  std::vector<float> Smoothed() const {
    std::vector<float> smooth(kLabCells, 0);
    constexpr std::array<int, 3> kStrides = {kChromas * kChromas, kChromas, 1};
    constexpr std::array<int, 3> kSizes = {kLightnesses, kChromas, kChromas};
    for (int cell = 0; cell < kLabCells; ++cell) {
      if (counts_[cell] == 0) continue;
      const float share = static_cast<float>(counts_[cell]) / static_cast<float>(total_);
      smooth[cell] += 0.4f * share;
      for (int axis = 0; axis < 3; ++axis) {
        const int at = cell / kStrides[axis] % kSizes[axis];
        smooth[at > 0 ? cell - kStrides[axis] : cell] += 0.1f * share;
        smooth[at + 1 < kSizes[axis] ? cell + kStrides[axis] : cell] += 0.1f * share;
      }
    }
    return smooth;
  }

  /// Share of the samples in the cells that are marked.
  double ShareIn(const std::vector<std::uint8_t>& marked) const {
    std::size_t in = 0;
    for (int cell = 0; cell < kLabCells; ++cell) in += marked[cell] ? counts_[cell] : 0;
    return static_cast<double>(in) / static_cast<double>(total_);
  }

 private:
  std::vector<std::size_t> counts_ = std::vector<std::size_t>(kLabCells, 0);
  std::size_t total_ = 0;
};

/// The outermost pixels of every view.
LabHistogram RimColours(const std::vector<DenseView>& views) {
  constexpr int kStep = 3;
  LabHistogram histogram;
  for (const DenseView& view : views) {
    const int width = view.rgb.width(), height = view.rgb.height(), rim = std::max(2, std::min(width, height) / 50);
    for (int y = 0; y < height; y += kStep) {
      for (int x = 0; x < width; x += kStep) {
        if (x < rim || y < rim || x >= width - rim || y >= height - rim) histogram.Add(ColourAt(view.rgb, x, y));
      }
    }
  }
  return histogram;
}

/// The pixels that show tracks.
LabHistogram TrackColours(const SparseModel& model, const RegionOfInterest& region,
                          const std::vector<DenseView>& views) {
  std::vector<int> slot_of_view(model.views.size(), -1);
  for (std::size_t i = 0; i < views.size(); ++i) slot_of_view[views[i].index] = static_cast<int>(i);
  LabHistogram histogram;
  for (const Track& track : model.tracks) {
    if (!region.Contains(track.position)) continue;
    for (const Observation& observation : track.observations) {
      const int slot = slot_of_view[observation.view];
      if (slot < 0) continue;
      const DenseView& view = views[slot];
      const Eigen::Vector2d pixel = view.camera.Pixel(view.cam_from_world * track.position);
      const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
      if (x >= 0 && y >= 0 && x < view.rgb.width() && y < view.rgb.height()) histogram.Add(ColourAt(view.rgb, x, y));
    }
  }
  return histogram;
}

/// Blocks reached from the border over marked blocks, in steps to the four sides.
std::vector<std::uint8_t> FloodFromBorder(const std::vector<std::uint8_t>& marked, int cols, int rows) {
  std::vector<std::uint8_t> reached(marked.size(), 0);
  std::vector<std::pair<int, int>> open;
  const auto visit = [&](int col, int row) {
    if (col < 0 || row < 0 || col >= cols || row >= rows) return;
    const std::size_t at = static_cast<std::size_t>(row) * cols + col;
    if (!marked[at] || reached[at]) return;
    reached[at] = 1;
    open.emplace_back(col, row);
  };
  for (int col = 0; col < cols; ++col) {
    visit(col, 0);
    visit(col, rows - 1);
  }
  for (int row = 0; row < rows; ++row) {
    visit(0, row);
    visit(cols - 1, row);
  }
  while (!open.empty()) {
    const auto [col, row] = open.back();
    open.pop_back();
    visit(col + 1, row);
    visit(col - 1, row);
    visit(col, row + 1);
    visit(col, row - 1);
  }
  return reached;
}

/// True when nearly all of a block's samples, four by four at most, have a background colour.
bool IsBackgroundBlock(const RgbImage& picture, const BackgroundColours& colours, int x0, int y0, int block) {
  const int step = std::max(1, block / 4);
  int samples = 0, background = 0;
  for (int y = y0; y < std::min(y0 + block, picture.height()); y += step) {
    for (int x = x0; x < std::min(x0 + block, picture.width()); x += step) {
      ++samples;
      background += colours.Contains(picture.Row(y) + 3 * x) ? 1 : 0;
    }
  }
  return background >= kFullBlock * samples;
}

}  // namespace

BackgroundColours BackgroundColours::Learn(const SparseModel& model, const RegionOfInterest& region,
                                           const std::vector<DenseView>& views) {
  BackgroundColours colours;
  const LabHistogram rim = RimColours(views), tracks = TrackColours(model, region, views);
  if (rim.Samples() < kLeastSamples || tracks.Samples() < kLeastSamples) return colours;
  const std::vector<float> rim_share = rim.Smoothed(), track_share = tracks.Smoothed();
  std::vector<std::uint8_t> is_background(kLabCells, 0);
  for (int cell = 0; cell < kLabCells; ++cell) {
    is_background[cell] = rim_share[cell] > kLeastFrequency && rim_share[cell] > kLikelier * track_share[cell] ? 1 : 0;
  }
  if (tracks.ShareIn(is_background) > kMostLostTracks || rim.ShareIn(is_background) < kLeastRim) return colours;
  constexpr int kStep = 256 / kSide;
  colours.table_.resize(static_cast<std::size_t>(kSide) * kSide * kSide);
  for (std::size_t i = 0; i < colours.table_.size(); ++i) {
    const auto level = [&](int shift) { return static_cast<std::uint8_t>((i >> shift) % kSide * kStep + kStep / 2); };
    colours.table_[i] = is_background[LabCell({level(2 * kBits), level(kBits), level(0)})];
  }
  return colours;
}

bool BackgroundColours::Contains(const std::uint8_t* rgb) const {
  constexpr int kDrop = 8 - kBits;
  return table_[(rgb[0] >> kDrop) << (2 * kBits) | (rgb[1] >> kDrop) << kBits | rgb[2] >> kDrop] != 0;
}

Silhouette::Silhouette(const RgbImage& picture, const BackgroundColours& colours) {
  if (colours.Empty()) return;
  block_ = std::max(2, std::max(picture.width(), picture.height()) / kBlocksAcross);
  cols_ = (picture.width() + block_ - 1) / block_;
  rows_ = (picture.height() + block_ - 1) / block_;
  std::vector<std::uint8_t> marked;
  for (int row = 0; row < rows_; ++row) {
    for (int col = 0; col < cols_; ++col) {
      marked.push_back(IsBackgroundBlock(picture, colours, col * block_, row * block_, block_) ? 1 : 0);
    }
  }
  background_ = FloodFromBorder(marked, cols_, rows_);
}

bool Silhouette::IsBackground(double u, double v) const {
  const double col = std::floor((u + 0.5) / block_), row = std::floor((v + 0.5) / block_);
  if (!(col >= 0 && row >= 0 && col < cols_ && row < rows_)) return false;
  return background_[static_cast<std::size_t>(row) * cols_ + static_cast<std::size_t>(col)] != 0;
}

std::vector<Silhouette> FindSilhouettes(const SparseModel& model, const RegionOfInterest& region,
                                        const std::vector<DenseView>& views) {
  const BackgroundColours colours = BackgroundColours::Learn(model, region, views);
  std::vector<Silhouette> silhouettes;
  for (const DenseView& view : views) silhouettes.emplace_back(view.rgb, colours);
  return silhouettes;
}

bool IsOutsideHull(const std::vector<DenseView>& views, const std::vector<Silhouette>& silhouettes,
                   const Eigen::Vector3d& point) {
  const std::size_t step = std::max<std::size_t>(1, views.size() / kViewsAsked);
  int asked = 0, outside = 0;
  for (std::size_t i = 0; i < views.size(); i += step) {
    const Eigen::Vector3d in_cam = views[i].cam_from_world * point;
    if (in_cam.z() <= 0) continue;
    const Eigen::Vector2d pixel = views[i].camera.Pixel(in_cam);
    ++asked;
    outside += silhouettes[i].IsBackground(pixel.x(), pixel.y()) ? 1 : 0;
  }
  return outside >= kLeastOutside && outside >= kLeastOutsideShare * asked;
}

}  // namespace drupe::dense
