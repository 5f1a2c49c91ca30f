#pragma once

#include <atomic>

namespace drupe {

/// A place among a limited number, given back on destruction.
class Admission {
 public:
  Admission() = default;
  /// Takes a place of `taken` unless `limit` are taken.
  Admission(std::atomic<int>& taken, int limit) : taken_(&taken) {
    if (taken.fetch_add(1) < limit) return;
    taken.fetch_sub(1);
    taken_ = nullptr;
  }
  ~Admission() {
    if (taken_ != nullptr) taken_->fetch_sub(1);
  }
  Admission(const Admission&) = delete;
  Admission& operator=(const Admission&) = delete;

  bool admitted() const { return taken_ != nullptr; }

 private:
  std::atomic<int>* taken_ = nullptr;
};

}  // namespace drupe
