#include "reconstruction/features/descriptor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "reconstruction/features/patch.h"

namespace drupe {
namespace {

constexpr int kBins = 36;
/// Lowe's: a further orientation must reach this share of the strongest, ...
constexpr float kPeakShare = 0.8f;
/// ... and a value of the normalised descriptor is cut off here, so that highlights do not rule it.
constexpr float kCutOff = 0.2f;

using Circle = std::array<float, kBins>;

/// The window's weight at each sample of the grid for orientations: a Gaussian of 1.5 sigma.
const std::array<float, kOrientationGrid * kOrientationGrid>& OrientationWindow() {
  static const auto window = [] {
    std::array<float, kOrientationGrid * kOrientationGrid> weights{};
    constexpr float kMiddle = (kOrientationGrid - 1) / 2.0f;
    constexpr float kSigma = kOrientationGrid / 6.0f;  // samples; the grid is six of them wide
    for (int y = 0; y < kOrientationGrid; ++y) {
      for (int x = 0; x < kOrientationGrid; ++x) {
        const float dx = static_cast<float>(x) - kMiddle, dy = static_cast<float>(y) - kMiddle;
        weights[y * kOrientationGrid + x] = std::exp(-(dx * dx + dy * dy) / (2 * kSigma * kSigma));
      }
    }
    return weights;
  }();
  return window;
}

Circle OrientationHistogram(const PatchGradient<kOrientationGrid>& gradient) {
  const auto& window = OrientationWindow();
  Circle histogram{};
  for (std::size_t i = 0; i < window.size(); ++i) {
    const float weight = window[i] * gradient.magnitude[i];
    const int bin = static_cast<int>(gradient.angle[i]);
    const float share = gradient.angle[i] - static_cast<float>(bin);
    histogram[bin % kBins] += weight * (1 - share);
    histogram[(bin + 1) % kBins] += weight * share;
  }
  return histogram;
}

/// Binomial smoothing over five bins.
Circle Smoothed(const Circle& in) {
  Circle out;
  for (int i = 0; i < kBins; ++i) {
    const auto at = [&](int k) { return in[(i + k + kBins) % kBins]; };
    out[i] = (at(-2) + at(2)) / 16 + (at(-1) + at(1)) / 4 + at(0) * 3 / 8;
  }
  return out;
}

struct Peak {
  float height, bin;
};

std::vector<Peak> PeaksOf(const Circle& histogram) {
  std::vector<Peak> peaks;
  const float highest = *std::max_element(histogram.begin(), histogram.end());
  for (int i = 0; i < kBins; ++i) {
    const float left = histogram[(i + kBins - 1) % kBins], right = histogram[(i + 1) % kBins], here = histogram[i];
    if (here <= left || here < right || here < kPeakShare * highest) continue;
    peaks.push_back({here, static_cast<float>(i) + 0.5f * (left - right) / (left - 2 * here + right)});
  }
  std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.height > b.height; });
  return peaks;
}

float AngleOfBin(float bin) {
  constexpr auto kPi = std::numbers::pi_v<float>;
  float angle = bin * 2 * kPi / kBins;
  if (angle >= kPi) angle -= 2 * kPi;
  return angle < -kPi ? angle + 2 * kPi : angle;
}

/// Lowe's normalisation, then the square root of the shares.
void Normalise(const CellHistogram& histogram, std::uint8_t* descriptor) {
  float squares = 0;
  for (const float v : histogram) squares += v * v;
  const float limit = kCutOff * std::sqrt(squares);
  float sum = 0;
  for (const float v : histogram) sum += std::min(v, limit);
  const float scale = sum > 0 ? 1 / sum : 0;
  for (int i = 0; i < Features::kDimension; ++i) {
    const float root = 512 * std::sqrt(std::min(histogram[i], limit) * scale);
    descriptor[i] = static_cast<std::uint8_t>(std::min(255.0f, root + 0.5f));
  }
}

}  // namespace

std::vector<float> DominantOrientations(const Octave& octave, const Extremum& extremum, int max_count) {
  PatchGradient<kOrientationGrid> gradient;
  const PatchFrame frame{extremum.x, extremum.y, 9 * extremum.sigma / kOrientationGrid, 1, 0};
  SampleOrientationPatch(octave.levels[extremum.level], frame, gradient);
  std::vector<Peak> peaks = PeaksOf(Smoothed(Smoothed(OrientationHistogram(gradient))));
  if (static_cast<int>(peaks.size()) > max_count) peaks.resize(max_count);
  std::vector<float> orientations;
  for (const Peak& peak : peaks) orientations.push_back(AngleOfBin(peak.bin));
  return orientations;
}

void DescribeExtremum(const Octave& octave, const Extremum& extremum, float orientation, std::uint8_t* descriptor) {
  const PatchFrame frame{extremum.x, extremum.y, 15 * extremum.sigma / kDescriptorGrid, std::cos(orientation),
                         std::sin(orientation)};
  CellHistogram histogram;
  SampleDescriptor(octave.levels[extremum.level], frame, histogram);
  Normalise(histogram, descriptor);
}

}  // namespace drupe
