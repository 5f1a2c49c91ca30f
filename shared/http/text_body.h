#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include "http/request.h"

namespace drupe {

/// For tests: a body that is held in memory.
class TextBody : public BodyReader {
 public:
  explicit TextBody(std::string text) : text_(std::move(text)) {}
  std::uint64_t length() const override { return text_.size(); }
  std::uint64_t remaining() const override { return text_.size() - position_; }
  Result<std::size_t> Read(std::span<char> buffer) override {
    const std::size_t count = text_.copy(buffer.data(), buffer.size(), position_);
    position_ += count;
    return count;
  }

 private:
  std::string text_;
  std::size_t position_ = 0;
};

}  // namespace drupe
