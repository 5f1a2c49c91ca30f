#pragma once

#include <charconv>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace drupe {

/// Builds text files of numbers: values separated by single spaces, the shortest decimal form that reads back to the
/// same value, whatever the locale.
class TextWriter {
 public:
  template <typename Number>
  requires std::is_arithmetic_v<Number> TextWriter& Add(Number value) {
    char digits[32];
    const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
    static_cast<void>(error);  // 32 characters hold every double
    return Add(std::string_view(digits, static_cast<std::size_t>(end - digits)));
  }
  TextWriter& Add(std::string_view word) {
    if (!text_.empty() && text_.back() != '\n') text_.push_back(' ');
    text_ += word;
    return *this;
  }
  TextWriter& EndLine() {
    text_.push_back('\n');
    return *this;
  }
  std::string Take() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace drupe
