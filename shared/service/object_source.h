#pragma once

#include <memory>
#include <span>
#include <utility>

#include "http/response.h"
#include "store/object_store.h"

namespace drupe {

/// An object as what a reply is sent from.
class ObjectSource : public ByteSource {
 public:
  explicit ObjectSource(std::unique_ptr<ObjectReader> reader) : reader_(std::move(reader)) {}
  std::uint64_t size() const override { return reader_->size(); }
  Result<std::size_t> ReadAt(std::uint64_t offset, std::span<char> buffer) override {
    return reader_->ReadAt(offset, std::as_writable_bytes(buffer));
  }

 private:
  std::unique_ptr<ObjectReader> reader_;
};

}  // namespace drupe
