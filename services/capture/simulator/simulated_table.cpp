#include "capture/simulator/simulated_table.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace drupe {
namespace {

constexpr std::chrono::milliseconds kTick{2};
constexpr double kEpsilonDeg = 1e-6;

}  // namespace

SimulatedTable::SimulatedTable(double pulse_spacing_deg, std::function<void(double)> on_pulse)
    : spacing_deg_(pulse_spacing_deg), on_pulse_(std::move(on_pulse)), thread_([this] { Run(); }) {}

SimulatedTable::~SimulatedTable() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

double SimulatedTable::position_deg() const {
  const std::lock_guard lock(mutex_);
  return position_;
}

bool SimulatedTable::moving() const {
  const std::lock_guard lock(mutex_);
  return position_ != target_;
}

void SimulatedTable::Move(double distance_deg, double speed_deg_s) {
  {
    const std::lock_guard lock(mutex_);
    target_ += distance_deg;
    speed_ = speed_deg_s;
  }
  wake_.notify_all();
}

void SimulatedTable::Stop() {
  const std::lock_guard lock(mutex_);
  target_ = position_;
}

void SimulatedTable::SetZero() {
  const std::lock_guard lock(mutex_);
  position_ = target_ = 0;
}

std::vector<double> SimulatedTable::Step(double seconds) {
  const double before = position_, left = target_ - position_;
  const double way = std::min(std::abs(left), speed_ * seconds);
  position_ = way == std::abs(left) ? target_ : position_ + std::copysign(way, left);
  // Leaving a multiple is no pulse, reaching it is one.
  const double low = std::min(before, position_), high = std::max(before, position_);
  const bool forward = position_ > before;
  const double from = (low + (forward ? kEpsilonDeg : -kEpsilonDeg)) / spacing_deg_;
  const double to = (high + (forward ? kEpsilonDeg : -kEpsilonDeg)) / spacing_deg_;
  std::vector<double> pulses;
  for (double multiple = std::floor(from) + 1; multiple <= std::floor(to); ++multiple) {
    pulses.push_back(multiple * spacing_deg_);
  }
  if (!forward) std::reverse(pulses.begin(), pulses.end());
  return pulses;
}

void SimulatedTable::Run() {
  auto last = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  while (!ending_) {
    if (position_ == target_) {
      wake_.wait(lock, [this] { return ending_ || position_ != target_; });
      last = std::chrono::steady_clock::now();
    }
    wake_.wait_for(lock, kTick, [this] { return ending_; });
    const auto now = std::chrono::steady_clock::now();
    const std::vector<double> pulses = Step(std::chrono::duration<double>(now - last).count());
    last = now;
    lock.unlock();
    for (const double position : pulses) {
      if (skipped_pulses_ > 0) {
        --skipped_pulses_;
      } else if (on_pulse_) {
        on_pulse_(position);
      }
    }
    lock.lock();
  }
}

}  // namespace drupe
