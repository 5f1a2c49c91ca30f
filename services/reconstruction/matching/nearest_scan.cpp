#include "reconstruction/matching/nearest_scan.h"

#include <algorithm>
#include <cstring>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reconstruction/matching/nearest_scan.cpp"
#include <hwy/foreach_target.h>  // NOLINT: includes this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace drupe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kBlock = PackedDescriptors::kBlock;
constexpr int kQuads = Features::kDimension / 4;

/// scores[q][l] = (query q) . (descriptor l of the block), the query's values being less by 128.
struct BlockScores {
  alignas(64) std::int32_t value[kQueryGroup][kBlock];
};

#if HWY_TARGET == HWY_AVX3_DL

/// Four products a lane and instruction: Highway 1.0 tests for this one (VNNI) before it chooses the target, but has no
/// name for it and does not enable it.
__attribute__((target("avx512vnni"), noinline)) void ScoreBlock(const std::int8_t* queries, const std::uint8_t* block,
                                                                BlockScores& scores) {
  __m512i sums[kQueryGroup];
  for (__m512i& sum : sums) sum = _mm512_setzero_si512();
  for (int quad = 0; quad < kQuads; ++quad) {
    const __m512i values = _mm512_loadu_si512(block + quad * 4 * kBlock);
    for (int q = 0; q < kQueryGroup; ++q) {
      std::int32_t query;
      std::memcpy(&query, queries + q * Features::kDimension + 4 * quad, sizeof(query));
      sums[q] = _mm512_dpbusd_epi32(sums[q], values, _mm512_set1_epi32(query));
    }
  }
  for (int q = 0; q < kQueryGroup; ++q) _mm512_store_si512(scores.value[q], sums[q]);
}

#else

/// Every product and sum is a whole number below 2^24, so float arithmetic is exact, and it is everywhere.
HWY_INLINE void ScoreBlock(const std::int8_t* queries, const std::uint8_t* block, BlockScores& scores) {
  const hn::CappedTag<float, kBlock> d;
  const hn::RebindToSigned<decltype(d)> d32;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int first = 0; first < kBlock; first += lanes) {
    hn::Vec<decltype(d)> sums[kQueryGroup];
    for (auto& sum : sums) sum = hn::Zero(d);
    for (int quad = 0; quad < kQuads; ++quad) {
      const auto bytes = hn::LoadU(d32, reinterpret_cast<const std::int32_t*>(block + (quad * kBlock + first) * 4));
      const auto low = hn::Set(d32, 255);
      const auto part = [&](int k) { return hn::ConvertTo(d, hn::And(hn::ShiftRightSame(bytes, 8 * k), low)); };
      const auto v0 = part(0), v1 = part(1), v2 = part(2), v3 = part(3);
      for (int q = 0; q < kQueryGroup; ++q) {
        const std::int8_t* query = queries + q * Features::kDimension + 4 * quad;
        sums[q] = hn::MulAdd(v0, hn::Set(d, query[0]), sums[q]);
        sums[q] = hn::MulAdd(v1, hn::Set(d, query[1]), sums[q]);
        sums[q] = hn::MulAdd(v2, hn::Set(d, query[2]), sums[q]);
        sums[q] = hn::MulAdd(v3, hn::Set(d, query[3]), sums[q]);
      }
    }
    for (int q = 0; q < kQueryGroup; ++q) hn::StoreU(hn::ConvertTo(d32, sums[q]), d32, scores.value[q] + first);
  }
}

#endif

HWY_INLINE void KeepBest(const BlockScores& scores, const std::int32_t* offsets, int block, LaneBest& out) {
  const hn::CappedTag<std::int32_t, kBlock> d;
  const auto this_block = hn::Set(d, block);
  for (int q = 0; q < kQueryGroup; ++q) {
    for (int l = 0; l < kBlock; l += static_cast<int>(hn::Lanes(d))) {
      const auto score = hn::Add(hn::LoadU(d, scores.value[q] + l), hn::LoadU(d, offsets + l));
      const auto best = hn::LoadU(d, out.best[q].data() + l);
      const auto second = hn::LoadU(d, out.second[q].data() + l);
      const auto where = hn::LoadU(d, out.block[q].data() + l);
      hn::StoreU(hn::Max(second, hn::Min(best, score)), d, out.second[q].data() + l);
      hn::StoreU(hn::IfThenElse(hn::Gt(score, best), this_block, where), d, out.block[q].data() + l);
      hn::StoreU(hn::Max(best, score), d, out.best[q].data() + l);
    }
  }
}

void Scan(const std::int8_t* queries, const PackedDescriptors& to, LaneBest& out) {
  for (int q = 0; q < kQueryGroup; ++q) {
    out.best[q].fill(std::numeric_limits<std::int32_t>::min());
    out.second[q].fill(std::numeric_limits<std::int32_t>::min());
    out.block[q].fill(-1);
  }
  BlockScores scores;
  for (std::size_t block = 0; block < to.BlockCount(); ++block) {
    ScoreBlock(queries, to.blocks.data() + block * kBlock * Features::kDimension, scores);
    KeepBest(scores, to.offsets.data() + block * kBlock, static_cast<int>(block), out);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace drupe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace drupe {

HWY_EXPORT(Scan);

void ScanBlocks(const std::int8_t* queries, const PackedDescriptors& to, LaneBest& out) {
  HWY_DYNAMIC_DISPATCH(Scan)(queries, to, out);
}

}  // namespace drupe
#endif
