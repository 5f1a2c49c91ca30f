#include "capture/simulator/simulated_table.h"

#include <cmath>
#include <utility>

namespace drupe {
namespace {

constexpr std::chrono::milliseconds kTick{2};
constexpr double kEpsilon = 1e-7;  // of a pulse's spacing

SimulatedTable::TimePoint Now() {
  return std::chrono::steady_clock::now();
}

}  // namespace

SimulatedTable::SimulatedTable(double pulse_spacing_deg, OnPulse on_pulse)
    : spacing_deg_(pulse_spacing_deg), on_pulse_(std::move(on_pulse)), at_(Now()), thread_([this] { Run(); }) {}

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
  return PositionAt(Now());
}

bool SimulatedTable::moving() const {
  const std::lock_guard lock(mutex_);
  return PositionAt(Now()) != target_;
}

void SimulatedTable::Move(double distance_deg, double speed_deg_s) {
  {
    const std::lock_guard lock(mutex_);
    Advance(Now());
    target_ += distance_deg;
    speed_ = speed_deg_s;
  }
  wake_.notify_all();
}

void SimulatedTable::Stop() {
  const std::lock_guard lock(mutex_);
  Advance(Now());
  target_ = position_;
}

void SimulatedTable::SetZero() {
  const std::lock_guard lock(mutex_);
  Advance(Now());
  position_ = target_ = 0;
}

double SimulatedTable::PositionAt(TimePoint now) const {
  const double left = target_ - position_;
  const double way = speed_ * std::chrono::duration<double>(now - at_).count();
  return way >= std::abs(left) ? target_ : position_ + std::copysign(way, left);
}

void SimulatedTable::Advance(TimePoint now) {
  const double before = position_;
  position_ = PositionAt(now);
  const TimePoint began = std::exchange(at_, now);
  if (position_ == before) return;
  // Leaving a multiple is no pulse, reaching it is one.
  const double way = position_ > before ? 1 : -1;
  const auto multiple_at = [&](double position) { return std::floor(way * position / spacing_deg_ + kEpsilon); };
  for (double multiple = multiple_at(before) + 1; multiple <= multiple_at(position_); ++multiple) {
    const double place = way * multiple * spacing_deg_;
    const std::chrono::duration<double> after(std::abs(place - before) / speed_);
    pulses_.push_back({place, began + std::chrono::duration_cast<TimePoint::duration>(after)});
  }
}

void SimulatedTable::Run() {
  std::unique_lock lock(mutex_);
  while (!ending_) {
    wake_.wait(lock, [this] { return ending_ || position_ != target_ || !pulses_.empty(); });
    wake_.wait_for(lock, kTick, [this] { return ending_; });
    Advance(Now());
    const std::vector<Pulse> pulses = std::exchange(pulses_, {});
    lock.unlock();
    for (const Pulse& pulse : pulses) {
      if (skipped_pulses_ > 0) {
        --skipped_pulses_;
      } else if (on_pulse_) {
        on_pulse_(pulse.position_deg, pulse.passed);
      }
    }
    lock.lock();
  }
}

}  // namespace drupe
