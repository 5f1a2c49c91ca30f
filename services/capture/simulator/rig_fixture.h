#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "capture/simulator/simulated_rig.h"

namespace drupe {

/// Waits until it is so; false if it is not within 2.5 s.
inline bool Becomes(const std::function<bool()>& condition) {
  for (int i = 0; i < 500 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return condition();
}

/// A simulated rig for a test. Every one has an address of its own on the loopback network.
/// `pictures` is a folder of the sample: what the camera sees.
inline std::unique_ptr<SimulatedRig> StartRig(SimulatedRigOptions options = {},
                                              const std::string& pictures = "images") {
  static std::atomic<int> number = 1;
  const std::string own = std::to_string(number++);
  options.pictures = std::string(DRUPE_TEST_DATA) + "/plum-s/" + pictures;
  options.address = "127.8.0." + own;
  options.serial = "RIG" + own;
  auto rig = SimulatedRig::Start(options);
  EXPECT_TRUE(rig.ok()) << rig.status().ToString();
  return rig.ok() ? std::move(*rig) : nullptr;
}

}  // namespace drupe
