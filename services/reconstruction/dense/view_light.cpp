#include "reconstruction/dense/view_light.h"

#include <algorithm>
#include <cmath>

namespace drupe::dense {

namespace {

constexpr int kLightRounds = 3;        ///< of weights
constexpr int kMostSweeps = 60;        ///< of one round
constexpr float kLightRest = 1e-4f;    ///< logarithmic green: a sweep that changes no field by more ends the round
constexpr float kAgreement = 0.06f;    ///< logarithmic green: residuals beyond count linearly
constexpr float kUsualLight = 0.05f;   ///< the same for the fields themselves
constexpr float kLightSmoothness = 1;  ///< weight of a step to a neighbouring cell, of a cell's usual weight
constexpr float kLightSize = 0.02f;    ///< weight of the fields' sizes, likewise

float HuberWeight(float residual, float scale) {
  return scale / std::max(scale, std::abs(residual));
}

/// The fields of one cell, one for each view that sees it, and the quadratic form that its points give: the points'
/// own colours are eliminated, which couples all fields of the cell.
struct CellFields {
  int first = 0, count = 0;        ///< in the list of all fields
  std::vector<float> form;         ///< count x count, symmetric
  std::vector<float> weights;      ///< by field: of its looks
  std::vector<int> neighbours;     ///< fields of the same view in the cells around, by field
  std::vector<int> neighbours_to;  ///< by field: the end of its neighbours
};

/// Iterates between the fields, given the weights of all looks, and these weights.
class LightSolver {
 public:
  LightSolver(const SurfaceGrid& grid, const std::vector<Eigen::Vector3f>& positions,
              const std::vector<LightSample>& samples, int view_count, std::vector<std::int32_t>* fields)
      : samples_(samples), view_count_(view_count), fields_(*fields), cells_(grid.cell_count()) {
    for (const LightSample& sample : samples) cell_of_.push_back(grid.CellOf(positions[sample.point]));
    NumberFields();
    LinkNeighbours(grid);
    values_.assign(right_.size(), Eigen::Array3f::Zero());
    looks_.assign(samples.size(), 1.0f);
  }

  std::vector<Eigen::Array3f> Solve() {
    for (int round = 0; round < kLightRounds; ++round) {
      BuildForms();
      for (int sweep = 0; sweep < kMostSweeps && Sweep() > kLightRest; ++sweep) {
      }
      WeighLooks();
    }
    return std::move(values_);
  }

 private:
  void NumberFields() {
    fields_.assign(cells_.size() * view_count_, -1);
    for (std::size_t i = 0; i < samples_.size(); ++i) fields_[FieldPlace(i)] = 0;
    int number = 0;
    for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
      cells_[cell].first = number;
      for (int view = 0; view < view_count_; ++view) {
        std::int32_t& field = fields_[cell * view_count_ + view];
        if (field >= 0) field = number++;
      }
      cells_[cell].count = number - cells_[cell].first;
    }
    right_.resize(number);
  }

  void LinkNeighbours(const SurfaceGrid& grid) {
    for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
      if (cells_[cell].count == 0) continue;
      const std::vector<int> around = grid.Around(static_cast<int>(cell));
      for (int view = 0; view < view_count_; ++view) {
        if (fields_[cell * view_count_ + view] < 0) continue;
        for (const int other : around) {
          const std::int32_t field = fields_[static_cast<std::size_t>(other) * view_count_ + view];
          if (field >= 0) cells_[cell].neighbours.push_back(field);
        }
        cells_[cell].neighbours_to.push_back(static_cast<int>(cells_[cell].neighbours.size()));
      }
    }
  }

  std::size_t FieldPlace(std::size_t sample) const {
    return static_cast<std::size_t>(cell_of_[sample]) * view_count_ + samples_[sample].view;
  }

  std::size_t EndOfPoint(std::size_t first) const {
    std::size_t end = first;
    while (end < samples_.size() && samples_[end].point == samples_[first].point) ++end;
    return end;
  }

  void BuildForms() {
    for (CellFields& cell : cells_) {
      cell.form.assign(static_cast<std::size_t>(cell.count) * cell.count, 0.0f);
      cell.weights.assign(cell.count, 0.0f);
    }
    std::fill(right_.begin(), right_.end(), Eigen::Array3f::Zero());
    for (std::size_t first = 0; first < samples_.size();) {
      const std::size_t end = EndOfPoint(first);
      AddPoint(first, end);
      first = end;
    }
    usual_weight_ = UsualWeight();
  }

  /// The looks first .. end - 1 at one point.
  void AddPoint(std::size_t first, std::size_t end) {
    CellFields& cell = cells_[cell_of_[first]];
    float total = 0;
    Eigen::Array3f mean = Eigen::Array3f::Zero();
    for (std::size_t i = first; i < end; ++i) {
      total += looks_[i] * samples_[i].weight;
      mean += looks_[i] * samples_[i].weight * samples_[i].log_colour;
    }
    mean /= total;
    for (std::size_t i = first; i < end; ++i) {
      const int field = fields_[FieldPlace(i)] - cell.first;
      const float weight = looks_[i] * samples_[i].weight;
      cell.weights[field] += weight;
      right_[cell.first + field] += weight * (samples_[i].log_colour - mean);
      for (std::size_t k = first; k < end; ++k) {
        const int other = fields_[FieldPlace(k)] - cell.first;
        cell.form[static_cast<std::size_t>(field) * cell.count + other] -=
            weight * looks_[k] * samples_[k].weight / total;
      }
    }
  }

  float UsualWeight() const {
    std::vector<float> all;
    for (const CellFields& cell : cells_) all.insert(all.end(), cell.weights.begin(), cell.weights.end());
    if (all.empty()) return 1;
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    return *middle;
  }

  /// One pass of Gauss-Seidel over all fields; returns the largest change.
  float Sweep() {
    float most = 0;
    for (const CellFields& cell : cells_) {
      for (int k = 0; k < cell.count; ++k) most = std::max(most, Relax(cell, k));
    }
    return most;
  }

  float Relax(const CellFields& cell, int k) {
    const float* row = cell.form.data() + static_cast<std::size_t>(k) * cell.count;
    Eigen::Array3f& value = values_[cell.first + k];
    Eigen::Array3f right = right_[cell.first + k];
    for (int other = 0; other < cell.count; ++other) {
      if (other != k) right -= row[other] * values_[cell.first + other];
    }
    const float step = kLightSmoothness * usual_weight_;
    float diagonal = cell.weights[k] + row[k] + kLightSize * usual_weight_ * HuberWeight(value[1], kUsualLight);
    for (int i = k == 0 ? 0 : cell.neighbours_to[k - 1]; i < cell.neighbours_to[k]; ++i) {
      right += step * values_[cell.neighbours[i]];
      diagonal += step;
    }
    const Eigen::Array3f solved = right / diagonal;
    const float change = std::abs(solved[1] - value[1]);
    value = solved;
    return change;
  }

  void WeighLooks() {
    for (std::size_t first = 0; first < samples_.size();) {
      const std::size_t end = EndOfPoint(first);
      float total = 0, mean = 0;
      for (std::size_t i = first; i < end; ++i) {
        total += looks_[i] * samples_[i].weight;
        mean += looks_[i] * samples_[i].weight * Green(i);
      }
      for (std::size_t i = first; i < end; ++i) looks_[i] = HuberWeight(Green(i) - mean / total, kAgreement);
      first = end;
    }
  }

  float Green(std::size_t sample) const {
    return samples_[sample].log_colour[1] - values_[fields_[FieldPlace(sample)]][1];
  }

  const std::vector<LightSample>& samples_;
  int view_count_;
  std::vector<std::int32_t>& fields_;
  std::vector<CellFields> cells_;
  std::vector<int> cell_of_;  ///< by sample
  std::vector<float> looks_;  ///< by sample: what it counts
  std::vector<Eigen::Array3f> right_, values_;
  float usual_weight_ = 1;
};

}  // namespace

ViewLight ViewLight::Fit(const SurfaceGrid& grid, const std::vector<Eigen::Vector3f>& positions,
                         const std::vector<LightSample>& samples, int view_count) {
  ViewLight light;
  light.view_count_ = view_count;
  light.values_ = LightSolver(grid, positions, samples, view_count, &light.fields_).Solve();
  return light;
}

Eigen::Array3f ViewLight::Log(const SurfaceGrid::Place& place, int view) const {
  Eigen::Array3f sum = Eigen::Array3f::Zero();
  if (values_.empty()) return sum;
  float weights = 0;
  for (int corner = 0; corner < 8; ++corner) {
    if (place.cells[corner] == SurfaceGrid::kNone) continue;
    const std::int32_t field = fields_[static_cast<std::size_t>(place.cells[corner]) * view_count_ + view];
    if (field < 0) continue;
    sum += place.weights[corner] * values_[field];
    weights += place.weights[corner];
  }
  return weights > 0 ? Eigen::Array3f(sum / weights) : sum;
}

}  // namespace drupe::dense
