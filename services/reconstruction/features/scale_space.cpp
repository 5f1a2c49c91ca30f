#include "reconstruction/features/scale_space.h"

#include <algorithm>
#include <cmath>

#include "reconstruction/features/blur.h"

namespace drupe {
namespace {

/// Rows that are carried through all levels before the next ones are begun, so that a level finds the one before in the
/// cache.
constexpr int kBandRows = 64;
/// An octave smaller than this has no room for a descriptor.
constexpr int kMinOctaveSide = 16;

/// The picture at twice the size, bilinear; sample (2x, 2y) is pixel (x, y).
GrayImage Doubled(const GrayImage& image) {
  GrayImage doubled(image.width() * 2, image.height() * 2);
  for (int y = 0; y < doubled.height(); ++y) {
    const std::uint8_t* top = image.Row(y / 2);
    const std::uint8_t* bottom = image.Row(std::min((y + 1) / 2, image.height() - 1));
    std::uint8_t* out = doubled.Row(y);
    for (int x = 0; x < image.width(); ++x) {
      const int next = std::min(x + 1, image.width() - 1);
      out[2 * x] = static_cast<std::uint8_t>((top[x] + bottom[x] + 1) / 2);
      out[2 * x + 1] = static_cast<std::uint8_t>((top[x] + top[next] + bottom[x] + bottom[next] + 2) / 4);
    }
  }
  return doubled;
}

/// Every second sample of every second row.
template <typename T>
Image<T> Halved(const Image<T>& image) {
  Image<T> halved(image.width() / 2, image.height() / 2);
  for (int y = 0; y < halved.height(); ++y) {
    const T* in = image.Row(2 * y);
    T* out = halved.Row(y);
    for (int x = 0; x < halved.width(); ++x) out[x] = in[2 * x];
  }
  return halved;
}

/// Builds the levels of one octave band by band.
class OctaveBuilder {
 public:
  OctaveBuilder(const FeatureOptions& options, const RunContext& context, OctaveObserver& observer)
      : context_(context), observer_(observer), level_count_(options.scales_per_octave + 3) {
    const double step = std::exp2(1.0 / options.scales_per_octave);
    for (int k = 1; k < level_count_; ++k) {
      const double from = options.base_sigma * std::pow(step, k - 1);
      kernels_.push_back(GaussianKernel(from * std::sqrt(step * step - 1)));
    }
  }

  /// An octave whose level 0 is still to be computed from `source` by `first`.
  Status Build(const GrayImage& source, const BlurKernel& first, int index, Octave& octave) const {
    octave.levels.emplace_back(source.width(), source.height());
    return Grow(index, octave, [&](int begin, int end) { BlurRows(source, first, begin, end, octave.levels[0]); });
  }

  /// An octave that has its level 0.
  Status Build(int index, Octave& octave) const {
    return Grow(index, octave, [](int, int) {});
  }

 private:
  template <typename MakeBase>
  Status Grow(int index, Octave& octave, const MakeBase& make_base) const {
    const int height = octave.height();
    while (static_cast<int>(octave.levels.size()) < level_count_) octave.levels.emplace_back(octave.width(), height);
    std::vector<int> done(level_count_, 0);
    while (done.back() < height) {
      DRUPE_RETURN_IF_ERROR(context_.CheckCancelled());
      const int base_end = std::min(height, done[0] + kBandRows);
      make_base(done[0], base_end);
      done[0] = base_end;
      for (int k = 1; k < level_count_; ++k) Advance(octave, k, done);
      observer_.OnRows(octave, index, done.back());
    }
    return Status::Ok();
  }

  void Advance(Octave& octave, int k, std::vector<int>& done) const {
    const int height = octave.height();
    const int end = done[k - 1] == height ? height : std::max(done[k], done[k - 1] - kernels_[k - 1].radius());
    BlurRows(octave.levels[k - 1], kernels_[k - 1], done[k], end, octave.levels[k]);
    done[k] = end;
  }

  const RunContext& context_;
  OctaveObserver& observer_;
  int level_count_;
  std::vector<BlurKernel> kernels_;  ///< the k-th takes level k to level k + 1
};

int FirstOctave(const GrayImage& image, const FeatureOptions& options) {
  if (options.first_octave) return *options.first_octave;
  const std::int64_t pixels = static_cast<std::int64_t>(image.width()) * image.height();
  return pixels <= options.doubling_max_pixels ? -1 : 0;
}

/// The octave that all others are made from: the picture at the size and blur of `first_octave`.
Status BuildFirst(const GrayImage& image, int first_octave, const FeatureOptions& options, const OctaveBuilder& builder,
                  Octave& octave) {
  octave.pixel_step = static_cast<float>(std::exp2(first_octave));
  const double input_sigma = options.input_sigma / octave.pixel_step;
  const auto added = [&](double sigma) { return GaussianKernel(std::sqrt(sigma * sigma - input_sigma * input_sigma)); };
  if (first_octave < 0) return builder.Build(Doubled(image), added(options.base_sigma), 0, octave);
  if (first_octave == 0) return builder.Build(image, added(options.base_sigma), 0, octave);
  // Blurred for the coarser grid before samples are left out.
  FloatImage blurred(image.width(), image.height());
  const double target = options.base_sigma * octave.pixel_step;
  const BlurKernel kernel = GaussianKernel(std::sqrt(target * target - options.input_sigma * options.input_sigma));
  BlurRows(image, kernel, 0, image.height(), blurred);
  for (int i = 0; i < first_octave; ++i) blurred = Halved(blurred);
  octave.levels.push_back(std::move(blurred));
  return builder.Build(0, octave);
}

}  // namespace

Result<std::vector<Octave>> BuildScaleSpace(const GrayImage& image, const FeatureOptions& options,
                                            const RunContext& context, OctaveObserver& observer) {
  const OctaveBuilder builder(options, context, observer);
  std::vector<Octave> octaves(1);
  DRUPE_RETURN_IF_ERROR(BuildFirst(image, FirstOctave(image, options), options, builder, octaves[0]));
  for (int i = 1; i < options.max_octaves; ++i) {
    const Octave& above = octaves.back();
    if (std::min(above.width(), above.height()) / 2 < kMinOctaveSide) break;
    Octave octave;
    octave.pixel_step = above.pixel_step * 2;
    octave.levels.push_back(Halved(above.levels[options.scales_per_octave]));
    DRUPE_RETURN_IF_ERROR(builder.Build(i, octave));
    octaves.push_back(std::move(octave));
  }
  return octaves;
}

}  // namespace drupe
