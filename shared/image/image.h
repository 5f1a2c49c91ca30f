#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>

namespace drupe {

/// A picture in memory: `channels` interleaved values a pixel, rows one below the other. Every row starts on a 64-byte
/// boundary and is padded to one, so that vector code may read (never rely on) up to 64 bytes past a row's last pixel.
/// Moves, never copies by accident: use Clone().
template <typename T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, int channels = 1)
      : width_(width), height_(height), channels_(channels), stride_(PaddedStride(width, channels)),
        data_(static_cast<T*>(::operator new[](AllocatedBytes(), std::align_val_t{64}))) {}

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  /// Values (not bytes) from one row to the next.
  std::ptrdiff_t stride() const { return stride_; }
  bool empty() const { return data_ == nullptr; }

  T* Row(int y) { return data_.get() + y * stride_; }
  const T* Row(int y) const { return data_.get() + y * stride_; }
  T& At(int x, int y, int channel = 0) { return Row(y)[x * channels_ + channel]; }
  const T& At(int x, int y, int channel = 0) const { return Row(y)[x * channels_ + channel]; }

  Image Clone() const {
    if (empty()) return Image();
    Image copy(width_, height_, channels_);
    for (std::ptrdiff_t i = 0; i < stride_ * height_; ++i) copy.data_.get()[i] = data_.get()[i];
    return copy;
  }

 private:
  static std::ptrdiff_t PaddedStride(int width, int channels) {
    constexpr std::ptrdiff_t kRowValues = 64 / sizeof(T);
    return (static_cast<std::ptrdiff_t>(width) * channels + kRowValues - 1) / kRowValues * kRowValues;
  }
  std::size_t AllocatedBytes() const { return static_cast<std::size_t>(stride_) * height_ * sizeof(T) + 64; }

  struct Free {
    void operator()(T* p) const { ::operator delete[](p, std::align_val_t{64}); }
  };

  int width_ = 0;
  int height_ = 0;
  int channels_ = 1;
  std::ptrdiff_t stride_ = 0;
  std::unique_ptr<T[], Free> data_;
};

using GrayImage = Image<std::uint8_t>;  ///< luma, 0..255
using RgbImage = Image<std::uint8_t>;   ///< 3 channels: red, green, blue (sRGB, 0..255)
using FloatImage = Image<float>;

}  // namespace drupe
