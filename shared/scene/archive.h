#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace drupe {

/// Plain data as bytes, in the order in which it is named: one list of a struct's fields serves for both ways.
///
///   template <typename Archive> void Fields(Archive& archive, SfmTrack& track) { archive(track.begin, track.end); }
///
/// Numbers are written as memory lies, so that what is read back is the same to the last bit.
class ArchiveWriter {
 public:
  template <typename... Values>
  void operator()(Values&... values) {
    (Put(values), ...);
  }
  std::string Take() { return std::move(bytes_); }

 private:
  static_assert(std::endian::native == std::endian::little, "numbers are written as memory lies");

  template <typename T>
  void Put(T& value) {
    if constexpr (std::is_arithmetic_v<T>) {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    } else {
      Fields(*this, value);
    }
  }
  template <typename Scalar, int kRows, int kCols>
  void Put(Eigen::Matrix<Scalar, kRows, kCols>& matrix) {
    bytes_.append(reinterpret_cast<const char*>(matrix.data()), sizeof(Scalar) * matrix.size());
  }
  template <typename T, std::size_t kCount>
  void Put(std::array<T, kCount>& values) {
    for (T& value : values) Put(value);
  }
  void Put(std::string& text) {
    PutSize(text.size());
    bytes_ += text;
  }
  template <typename T>
  void Put(std::vector<T>& values) {
    PutSize(values.size());
    for (T& value : values) Put(value);
  }
  template <typename T>
  void Put(std::optional<T>& value) {
    bool is_there = value.has_value();
    Put(is_there);
    if (is_there) Put(*value);
  }
  void PutSize(std::uint64_t size) { Put(size); }

  std::string bytes_;
};

/// Reads what ArchiveWriter wrote. What comes after the first thing that does not fit stays as it is.
class ArchiveReader {
 public:
  explicit ArchiveReader(std::string_view bytes) : rest_(bytes) {}

  template <typename... Values>
  void operator()(Values&... values) {
    (Take(values), ...);
  }
  /// Whether everything was there, and nothing else.
  bool Complete() const { return good_ && rest_.empty(); }

 private:
  template <typename T>
  void Take(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = 0;
      TakeRaw(&byte, 1);
      value = byte != 0;
    } else if constexpr (std::is_arithmetic_v<T>) {
      TakeRaw(&value, sizeof(T));
    } else {
      Fields(*this, value);
    }
  }
  template <typename Scalar, int kRows, int kCols>
  void Take(Eigen::Matrix<Scalar, kRows, kCols>& matrix) {
    TakeRaw(matrix.data(), sizeof(Scalar) * matrix.size());
  }
  template <typename T, std::size_t kCount>
  void Take(std::array<T, kCount>& values) {
    for (T& value : values) Take(value);
  }
  void Take(std::string& text) {
    text.resize(TakeSize());
    TakeRaw(text.data(), text.size());
  }
  template <typename T>
  void Take(std::vector<T>& values) {
    const std::size_t size = TakeSize();
    values.clear();
    for (std::size_t k = 0; k < size && good_; ++k) Take(values.emplace_back());
  }
  template <typename T>
  void Take(std::optional<T>& value) {
    bool is_there = false;
    Take(is_there);
    value.reset();
    if (is_there) Take(value.emplace());
  }
  /// Nothing takes less than a byte, so that no size is believed beyond what is left.
  std::size_t TakeSize() {
    std::uint64_t size = 0;
    Take(size);
    if (size > rest_.size()) good_ = false;
    return good_ ? static_cast<std::size_t>(size) : 0;
  }
  void TakeRaw(void* value, std::size_t size) {
    if (size > rest_.size()) good_ = false;
    if (!good_) return;
    std::memcpy(value, rest_.data(), size);
    rest_.remove_prefix(size);
  }

  std::string_view rest_;
  bool good_ = true;
};

}  // namespace drupe
