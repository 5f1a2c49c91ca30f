#include "capture/camera/agreed_detail.h"

#include <cstdint>
#include <vector>

namespace drupe {
namespace {

constexpr int kWritten = 1;  ///< into the margin
constexpr int kAround = 3;   ///< cells on all sides of one, over which agreement is sought

/// Of what differences measured across and down have more than the filtered ones, u and v, and of how much they bend
/// from pixel to pixel, p and q, and by how much samples change, s and t: sums of 2 u v and of
/// u^2 + v^2 + (p^2 + q^2) / 2 + s^2 + t^2, over columns of cells from 3 above a row to 3 below it, which move down row
/// by row.
class ProductSums {
 public:
  ProductSums(const MeasuredColour& measured, const Lattice& filtered)
      : measured_(measured),
        filtered_(filtered),
        common_(static_cast<std::size_t>(filtered.columns() + 2 * kReach)),
        all_(common_.size()) {
    for (int y = -kWritten - kAround; y < -kWritten + kAround; ++y) Add<1>(y);
  }

  void MoveTo(int y) {
    if (y > -kWritten) Add<-1>(y - 1 - kAround);
    Add<1>(y + kAround);
  }
  const std::int32_t* common() const { return common_.data() + kReach; }
  const std::int32_t* all() const { return all_.data() + kReach; }

 private:
  static constexpr int kReach = kWritten + kAround;

  /// Differences are of 1020 at most, u, v, p and q of 3060: the sums over 7 x 7 cells fit.
  template <int sign>
  void Add(int y) {
    const std::int16_t* filtered = filtered_.Row(y) - kReach;
    const std::int16_t *across = measured_.across.of_three.Row(y) - kReach, *a = measured_.across.own.Row(y) - kReach;
    const std::int16_t *down = measured_.down.of_three.Row(y) - kReach, *d = measured_.down.own.Row(y) - kReach;
    const std::int16_t* a_step = measured_.across.step.Row(y) - kReach;
    const std::int16_t* d_step = measured_.down.step.Row(y) - kReach;
    for (std::size_t i = 0; i < common_.size(); ++i) {
      const int u = (across[i] - 3 * filtered[i]) >> 1, v = (down[i] - 3 * filtered[i]) >> 1;
      const int p = (across[i] - 3 * a[i]) >> 1, q = (down[i] - 3 * d[i]) >> 1;
      common_[i] += sign * 2 * u * v;
      const int steps = a_step[i] * a_step[i] + d_step[i] * d_step[i];
      all_[i] += sign * (u * u + v * v + ((p * p + q * q) >> 1) + steps);
    }
  }

  const MeasuredColour& measured_;
  const Lattice& filtered_;
  std::vector<std::int32_t> common_, all_;
};

inline int SumOfSeven(const std::int32_t* middle) {
  return middle[-3] + middle[-2] + middle[-1] + middle[0] + middle[1] + middle[2] + middle[3];
}

/// How much of the detail is no noise. White noise has a third in common, through the sample that both directions
/// share; half counts as nothing.
inline float ShareKept(int common, int all) {
  const float agreed = 2 * static_cast<float>(common) - static_cast<float>(all);
  return agreed > 0 ? 8 * agreed / (7 * agreed + static_cast<float>(all)) : 0;
}

inline std::int16_t Towards(std::int16_t filtered, std::int16_t measured, float share) {
  return RoundedSteps(static_cast<float>(filtered) + share * static_cast<float>(measured - filtered));
}

}  // namespace

void RestoreAgreedDetail(const MeasuredColour& measured, Lattice& fine, Lattice& even) {
  const Lattice filtered = Smooth(even, Smoothing::kStrong, kWritten + kAround);
  ProductSums sums(measured, filtered);
  std::vector<float> shares(static_cast<std::size_t>(even.columns() + 2 * kWritten));
  for (int y = -kWritten; y < even.rows() + kWritten; ++y) {
    sums.MoveTo(y);
    const std::int32_t *common = sums.common() - kWritten, *all = sums.all() - kWritten;
    for (std::size_t i = 0; i < shares.size(); ++i) shares[i] = ShareKept(SumOfSeven(common + i), SumOfSeven(all + i));
    const std::int16_t* detailed = measured.difference.Row(y) - kWritten;
    std::int16_t *fine_row = fine.Row(y) - kWritten, *even_row = even.Row(y) - kWritten;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      fine_row[i] = Towards(fine_row[i], detailed[i], shares[i]);
      even_row[i] = Towards(even_row[i], detailed[i], shares[i]);
    }
  }
}

}  // namespace drupe
