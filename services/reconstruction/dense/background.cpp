#include "reconstruction/dense/background.h"

#include <algorithm>
#include <array>
#include <cmath>

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
constexpr double kDarkShare = 1.0 / 12;  ///< of the tracks' luminance: black cloth's share of a common object's

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

  /// The median L*, to half a cell.
  double MedianLightness() const {
    std::size_t below = 0;
    int cell = 0;
    while (cell < kLabCells - 1 && 2 * (below + counts_[cell]) < total_) below += counts_[cell++];
    return (cell / (kChromas * kChromas) + 0.5) * 100 / kLightnesses;
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

double LuminanceOfLightness(double lightness) {
  return std::pow((lightness + 16) / 116, 3);
}

/// The L* below which a colour is background before black cloth, where folds may be textured but reflect a few percent
/// of what the object does; 0 where the pictures' rims are not that dark.
double DarkLightness(const LabHistogram& rim, const LabHistogram& tracks) {
  const double dark = kDarkShare * LuminanceOfLightness(tracks.MedianLightness());
  return LuminanceOfLightness(rim.MedianLightness()) < dark ? 116 * std::cbrt(dark) - 16 : 0;
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
  const double dark_lightness = DarkLightness(rim, tracks);
  constexpr int kStep = 256 / kSide;
  colours.table_.resize(static_cast<std::size_t>(kSide) * kSide * kSide);
  for (std::size_t i = 0; i < colours.table_.size(); ++i) {
    const auto level = [&](int shift) { return static_cast<std::uint8_t>((i >> shift) % kSide * kStep + kStep / 2); };
    const Rgb8 colour{level(2 * kBits), level(kBits), level(0)};
    const bool dark = LabFromSrgb(colour)[0] < dark_lightness;
    colours.table_[i] = dark || is_background[LabCell(colour)] ? 1 : 0;
  }
  return colours;
}

bool BackgroundColours::Contains(const std::uint8_t* rgb) const {
  constexpr int kDrop = 8 - kBits;
  return table_[(rgb[0] >> kDrop) << (2 * kBits) | (rgb[1] >> kDrop) << kBits | rgb[2] >> kDrop] != 0;
}

}  // namespace drupe::dense
