#include "scene/descriptor_distance.h"

#include "scene/features.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/descriptor_distance.cpp"
#include <hwy/foreach_target.h>  // NOLINT: includes this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace drupe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Differences have 9 bits and their squares' sum 23, so 16 and 32 bits hold them.
std::int32_t Distance(const std::uint8_t* a, const std::uint8_t* b) {
  const hn::ScalableTag<std::int16_t> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const hn::RepartitionToWide<decltype(d16)> d32;
  auto low = hn::Zero(d32), high = hn::Zero(d32);
  for (int k = 0; k < Features::kDimension; k += static_cast<int>(hn::Lanes(d16))) {
    const auto difference = hn::Sub(hn::PromoteTo(d16, hn::LoadU(d8, a + k)), hn::PromoteTo(d16, hn::LoadU(d8, b + k)));
    low = hn::ReorderWidenMulAccumulate(d32, difference, difference, low, high);
  }
  return hn::GetLane(hn::SumOfLanes(d32, hn::Add(low, high)));
}

}  // namespace HWY_NAMESPACE
}  // namespace drupe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace drupe {

HWY_EXPORT(Distance);

std::int32_t SquaredDistance(const std::uint8_t* a, const std::uint8_t* b) {
  return HWY_DYNAMIC_DISPATCH(Distance)(a, b);
}

}  // namespace drupe
#endif
